"""A furnished room that stands: made, exported, settled, and freed of what moves."""

from __future__ import annotations

import dataclasses
import shutil
import tempfile
from pathlib import Path

import numpy as np

from .. import export, stability, synthetic
from ..cad.collision import making_hulls
from ..classes import class_named
from ..config import ExportSettings, StabilitySettings
from ..errors import SceneError
from ..library import CadLibrary
from ..runtime.reporter import LogReporter, Reporter
from ..stability import StabilityReport
from ..synthetic import PlacedModel, Room

MAX_DRIFT_M = 0.005
"""Of a body in the time of the simulation, from where the room has it."""
MAX_PENETRATION_M = 0.001
"""At the start, between two bodies of which one can move."""
MAX_JOINT_DRIFT = 0.02
"""Radians, or of slides as many quarters of a metre: 5 mm at 25 cm from the hinge."""
TAKEN_AWAY = "taken away"
"""In the notes of a room, of what did not stand."""
_SLIDE_M = 0.25
_WORTH_SAYING_M = 1e-4
_WITH_ASSETS = ("assets", "map", "scene_description")
"""Folders of an exported scene with a file or more for each body."""
_ROUNDS = 8
_EXPORT = ExportSettings(max_shift_m=MAX_DRIFT_M)
_SETTLED = StabilitySettings(duration_s=5.0, perturbed_resets=0)


@dataclasses.dataclass(frozen=True, eq=False)
class StandingRoom:
    """A room in which nothing moves by itself, and the proof."""

    room: Room
    """At the poses of the twin; its notes say what was taken away."""
    report: StabilityReport
    """Of the twin that stands."""
    removed: tuple[str, ...]
    """Names of what was taken away."""
    rounds: int
    """Simulations until nothing moved: 1 = the room stood as it was made."""
    library: CadLibrary
    """That furnished it, its models with collision hulls."""


def standing_room(
    seed: int,
    library: CadLibrary,
    *,
    kind: str | None = None,
    ceiling: bool = True,
    twin_dir: Path | None = None,
    reporter: Reporter | None = None,
) -> StandingRoom:
    """A room that stands still in MuJoCo for 5 s: what moves is taken away, and what it carries.

    Args:
        seed: Of `make_room`.
        library: Furnishes the room. Models without collision hulls get them (``vhacd``).
        kind: Of the room; None: drawn from the seed.
        ceiling: Whether the room has one.
        twin_dir: Keeps the scene that stands: ``scene.xml``, its assets, ``stability.json``. What
            hangs and stuff (windows, pictures) are fixed bodies of it. None: it is made in a
            temporary folder.
        reporter: Told what was taken away.

    Raises:
        SceneError: no arrangement was found, or something still moves after `_ROUNDS` rounds.
        LibraryError: the library lacks what such a room cannot be without.
        SettingError: there is no such kind of room.
    """
    room = synthetic.make_room(seed, library, kind=kind, ceiling=ceiling)
    return made_to_stand(room, library, twin_dir=twin_dir, reporter=reporter)


def made_to_stand(
    room: Room,
    library: CadLibrary,
    *,
    twin_dir: Path | None = None,
    reporter: Reporter | None = None,
) -> StandingRoom:
    """As `standing_room`, for a room that is there already.

    Raises:
        SceneError: something still moves after `_ROUNDS` rounds.
        OutputError: the scene cannot be written.
    """
    reporter = reporter or LogReporter()
    if twin_dir is not None:
        return _settled(room, library, Path(twin_dir), reporter)
    with tempfile.TemporaryDirectory() as folder:
        return _settled(room, library, Path(folder), reporter)


def _settled(room: Room, library: CadLibrary, folder: Path, reporter: Reporter) -> StandingRoom:
    room, library = _with_hulls(room, library, reporter)
    drawn = {item.name: item.center for item in room.items}
    removed: list[str] = []
    for done in range(1, _ROUNDS + 1):
        exported = _exported(room, library, folder)
        report = stability.settle(folder / "scene.xml", _SETTLED)
        faults = _faults(exported, report)
        if not faults:
            report.write(folder / "stability.json")
            exported = _noted(exported, drawn)
            return StandingRoom(exported, report, tuple(removed), done, library)
        for part in _WITH_ASSETS:  # of what is taken away, too
            shutil.rmtree(folder / part, ignore_errors=True)
        room, notes, gone = without(room, faults)
        removed += gone
        for note in notes:
            reporter.note(f"{room.name}: {note}")
    raise SceneError(
        f"{room.name} does not stand: after {_ROUNDS} rounds {', '.join(removed)} were taken away",
        "use another seed",
    )


def _noted(room: Room, drawn: dict[str, np.ndarray]) -> Room:
    """The room with a note of what stands a little off where it was put."""
    moved = {
        item.name: float(np.linalg.norm(item.center - drawn[item.name])) for item in room.items
    }
    moved = {name: step for name, step in moved.items() if step > _WORTH_SAYING_M}
    if not moved:
        return room
    far = max(moved, key=lambda name: moved[name])
    note = (
        f"moved to touch the collision hulls of what carries it: {len(moved)} of "
        f"{len(room.items)}, {far} farthest, by {1000 * moved[far]:.1f} mm"
    )
    return dataclasses.replace(room, notes=(*room.notes, note))


def _with_hulls(room: Room, library: CadLibrary, reporter: Reporter) -> tuple[Room, CadLibrary]:
    """Room and library with collision hulls for the models of the room."""
    used = [library.position(item.model.id) for item in room.items]
    ready = making_hulls(library, reporter).with_hulls(used, "vhacd")
    items = tuple(
        dataclasses.replace(item, model=ready.by_id(item.model.id)) for item in room.items
    )
    return dataclasses.replace(room, items=items), ready


def _exported(room: Room, library: CadLibrary, folder: Path) -> Room:
    """Write the true scene; the room at the poses that were written.

    Export sets free bodies down on what carries them: hulls of imported models reach a little
    beyond their surface, so a cup on such a table stands higher. Up to `MAX_DRIFT_M` of that is
    taken over into the room; what would need more stays, and falls.
    """
    entities = synthetic.true_entities(room, spacing_m=1.0, with_stuff=True)
    graph = synthetic.true_graph(room, entities)
    placements = synthetic.true_placements(room, entities)
    scene = export.export_scene(entities, graph, placements, library, folder, _EXPORT)
    poses = {e.name: e.cad.T_world_cad for e in scene.entities if e.cad is not None}
    items = []
    for item in room.items:
        T = item.T_world_cad.copy()
        T[:3, 3] = poses[item.name][:3, 3]
        items.append(dataclasses.replace(item, T_world_cad=T))
    return dataclasses.replace(room, items=tuple(items))


def _faults(room: Room, report: StabilityReport) -> dict[str, str]:
    """Names of items that move or overlap, and why."""
    found: dict[str, str] = {}
    owner = _owners(room)
    for overlap in report.exported.overlaps:
        if overlap.depth_m > MAX_PENETRATION_M:
            name = _to_remove(room, owner.get(overlap.body_a), owner.get(overlap.body_b))
            what = f"{1000 * overlap.depth_m:.1f} mm of {overlap.body_a} in {overlap.body_b}"
            found.setdefault(name, what)
    for motion in report.exported.bodies:
        if motion.left_room or not motion.drift_end_m <= MAX_DRIFT_M:
            drift = f"moved {1000 * motion.drift_end_m:.1f} mm"
            found.setdefault(owner[motion.name], drift)
    kinds = _joint_kinds(room)
    for joint in report.exported.joints:
        name, kind = kinds[joint.name]
        strayed = joint.strayed / (_SLIDE_M if kind == "prismatic" else 1.0)
        if not strayed <= MAX_JOINT_DRIFT:
            found.setdefault(name, f"its {joint.name} moved by itself")
    return found


def _owners(room: Room) -> dict[str, str]:
    """Item by the names of its bodies in the scene."""
    owner = {item.name: item.name for item in room.items}
    for item in room.items:
        owner |= {f"{item.name}_{link.name}": item.name for link in item.model.robot.links[1:]}
    return owner


def _joint_kinds(room: Room) -> dict[str, tuple[str, str]]:
    """Item and kind by the names of its joints in the scene."""
    return {
        f"{item.name}_{joint.name}": (item.name, joint.kind)
        for item in room.items
        for joint in item.model.robot.joints
    }


def _to_remove(room: Room, a: str | None, b: str | None) -> str:
    """Of two that overlap the one farther up, and on one height the later one.

    Of an item and the layout, or a door or window in it, the item: an opening would stay.
    """
    order = {item.name: i for i, item in enumerate(room.items) if item.name in (a, b)}
    in_opening = {
        name for name in order if class_named(room.item(name).model.class_name).mount == "opening"
    }
    return max(
        order, key=lambda name: (name not in in_opening, room.support_depth(name), order[name])
    )


def without(room: Room, faults: dict[str, str]) -> tuple[Room, tuple[str, ...], tuple[str, ...]]:
    """The room without these items and all that they carry; what to say of it, and their names.

    Ids of the others stay as they are.
    """
    gone, notes = list(faults), []
    for name in gone:
        gone += [item.name for item in room.items if item.parent == name and item.name not in gone]
    for name, why in faults.items():
        carried = [item.name for item in carried_by(room, name)]
        also = f", and with it {', '.join(carried)}" if carried else ""
        notes.append(f"{name} {TAKEN_AWAY}: {why}{also}")
    items = tuple(item for item in room.items if item.name not in gone)
    kept = dataclasses.replace(room, items=items, notes=(*room.notes, *notes))
    return kept, tuple(notes), tuple(gone)


def carried_by(room: Room, name: str) -> tuple[PlacedModel, ...]:
    """All that an item carries, directly or not."""
    names = [name]
    for carrier in names:
        names += [item.name for item in room.items if item.parent == carrier]
    return tuple(item for item in room.items if item.name in names[1:])
