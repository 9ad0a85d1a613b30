"""A found model made into one of a library: canonical pose, class, planes, masses, handles."""

from __future__ import annotations

import dataclasses

import numpy as np

from ....classes import Mount, class_named
from ....errors import LibraryError
from ....library import CadModel, held
from ....robot_model import RobotModel
from ....types import PlaneSet
from ...model_files import with_content_hash
from ...planes import Plane
from ..found import FoundModel
from ..names import slug
from .class_guess import OTHER, guess_class
from .handles import find_handles
from .mass import with_masses
from .placing import reversed_faces
from .planes import find_planes, needs_seat, soft_seats
from .posing import body_faces, centred, posed
from .settings import DEFAULT, ConvertSettings
from .skin import Skin, skin_of
from .symmetry import symmetry_order
from .winding import find_winding

_UNKNOWN = "unknown"
_ROUGH_M = 0.004
_HUNG_M = 1.2
"""What is higher above the floor stands on no furniture."""
_FRONTED = frozenset(
    [
        "cabinet",
        "wall_cabinet",
        "drawer_unit",
        "wardrobe",
        "nightstand",
        "fridge",
        "oven",
        "dishwasher",
        "washing_machine",
        "microwave",
        "monitor",
        "laptop",
        "desk",
        "bed",
    ]
)
"""Their fronts count, also where a closed box is all that is seen."""
_SOFT = frozenset(["chair", "stool", "bench", "sofa", "bed", "cushion", "toilet"])
"""What they carry lies on surfaces that are not quite flat."""


def convert(found: FoundModel, settings: ConvertSettings = DEFAULT) -> CadModel:
    """The library model of what a reader found; its hulls are not made yet.

    What was guessed or repaired stands in the model's notes.

    Raises:
        LibraryError: no faces, numbers that are no numbers, or no unit makes its size plausible.
    """
    _require_geometry(found)
    notes = list(found.notes)
    class_name = _hung(_class_of(found, notes), found, notes)
    robot, class_name = posed(found, class_name, settings, notes)
    robot, skin, sheet = _repaired(robot, notes)
    body = body_faces(robot, skin)
    robot, skin, size = centred(robot, skin, body, settings, notes)
    robot = _with_whole_collision(robot, notes)
    _check_joints(robot, notes)
    robot, mass_note = with_masses(robot, skin, class_name, found.mass_kg)
    notes += [mass_note] if mass_note else []
    names = tuple(link.name for link in robot.links)
    planes = find_planes(skin, sheet, body, names, settings)
    if class_name in _SOFT and needs_seat(planes, skin):
        seats = soft_seats(skin, sheet, names)
        planes = seats + planes
        notes += ["seat planes estimated: upholstery is only roughly level"] if seats else []
    mount = _mount(found, class_name, notes)
    fixed_front = bool(robot.moving_joints) or class_name in _FRONTED
    model = CadModel(
        id=f"{class_name}/{slug(found.name)}",
        class_name=class_name,
        load_robot=held(robot),
        moving_joints=tuple(joint.name for joint in robot.moving_joints),
        size=size,
        planes=_plane_set(planes, size),
        plane_link=tuple(plane.link for plane in planes),
        plane_supporting=np.array([plane.supporting for plane in planes], bool),
        symmetry=1 if fixed_front else symmetry_order(skin, settings.symmetry_share),
        mount=mount,
        licence=found.licence or _UNKNOWN,
        content_hash="",
        handles=find_handles(robot, found.handles),
        collision="stated" if any(link.hulls for link in robot.links) else "none",
        creator=found.creator or _UNKNOWN,
        source=found.source,
        notes=tuple(notes),
    )
    return with_content_hash(model)


def _require_geometry(found: FoundModel) -> None:
    meshes = [visual.mesh for link in found.robot.links for visual in link.visuals]
    if not any(len(mesh.faces) for mesh in meshes):
        hint = "export it as triangles; points and curves alone are no model"
        raise LibraryError(f"{found.source}: no faces", hint)
    if not all(np.all(np.isfinite(mesh.vertices)) for mesh in meshes):
        hint = "repair it in a mesh editor and add it again"
        raise LibraryError(f"{found.source}: vertices that are no numbers", hint)


def _class_of(found: FoundModel, notes: list[str]) -> str:
    if found.class_name is not None:
        return found.class_name
    guess = guess_class((found.name, *found.tags))
    if guess.class_name != OTHER:
        notes.append(f"class guessed: {guess.class_name} from {guess.words!r}")
    else:
        notes.append(f"class unknown ({guess.words or found.name!r} is none of ours): {OTHER}")
    return guess.class_name


def _hung(class_name: str, found: FoundModel, notes: list[str]) -> str:
    """The class that such a thing has where it hangs, if its file says that it hangs."""
    hung = class_named(class_name).hung_class
    if hung and found.class_name is None and (found.elevation_m or 0.0) >= _HUNG_M:
        notes.append(f"hangs {found.elevation_m:.2f} m above the floor: {hung}")
        return hung
    return class_name


def _mount(found: FoundModel, class_name: str, notes: list[str]) -> Mount:
    usual = class_named(class_name).mount
    if found.mount is not None:
        return found.mount
    if usual in ("floor", "surface") and (found.elevation_m or 0.0) >= _HUNG_M:
        notes.append(f"hangs {found.elevation_m:.2f} m above the floor: mounted on a wall")
        return "wall"
    return usual


def _repaired(robot: RobotModel, notes: list[str]) -> tuple[RobotModel, Skin, np.ndarray]:
    """All faces wound outwards; which of them are two-sided sheets."""
    skin = skin_of(robot)
    winding = find_winding(skin)
    # A face that the file has both ways round is right whichever is seen.
    wrong = winding.flip & ~skin.doubled
    if not wrong.any():
        return robot, skin.flipped(winding.flip), winding.sheet
    share = float(skin.area[wrong].sum() / skin.area.sum())
    notes.append(f"faces inside out: {wrong.sum()} flipped ({share:.1%} of the surface)")
    links, position = [], 0
    for link in robot.links:
        visuals = []
        for visual in link.visuals:
            rows = skin.row[wrong & (skin.visual == position)]
            if len(rows):
                flip = np.zeros(len(visual.mesh.faces), bool)
                flip[rows] = True
                visual = dataclasses.replace(visual, mesh=reversed_faces(visual.mesh, flip))
            visuals.append(visual)
            position += 1
        links.append(dataclasses.replace(link, visuals=tuple(visuals)))
    repaired = dataclasses.replace(robot, links=tuple(links))
    return repaired, skin.flipped(winding.flip), winding.sheet


def _with_whole_collision(robot: RobotModel, notes: list[str]) -> RobotModel:
    """Stated hulls only where every link that is seen has some: else all are made anew."""
    without = [link.name for link in robot.links if link.visuals and not link.hulls]
    if not without or not any(link.hulls for link in robot.links):
        return robot
    notes.append(f"no collision shapes of {', '.join(without)}: hulls of all links will be made")
    links = tuple(dataclasses.replace(link, hulls=()) for link in robot.links)
    return dataclasses.replace(robot, links=links)


def _check_joints(robot: RobotModel, notes: list[str]) -> None:
    for joint in robot.moving_joints:
        if joint.kind == "continuous":
            continue
        if not joint.lower <= 0 <= joint.upper:
            span = f"{joint.lower:.3g} to {joint.upper:.3g}"
            notes.append(f"joint {joint.name}: its zero lies outside its range, {span}")


def _plane_set(planes: list[Plane], size: np.ndarray) -> PlaneSet:
    normal = np.array([p.normal for p in planes]).reshape(-1, 3)
    corners = np.array([p.corners for p in planes]).reshape(-1, 4, 3)
    # Means of faces that are not quite flat may reach out of the box by fractions of a millimetre.
    inside = np.clip(corners, -size / 2, size / 2)
    corners = np.where(np.abs(inside - corners) < _ROUGH_M, inside, corners)
    offset = -np.einsum("pc,pkc->pk", normal, corners).mean(1)
    return PlaneSet(
        (np.round(normal, 6) + 0.0).astype(np.float32),
        (np.round(offset, 6) + 0.0).astype(np.float32),
        (np.round(corners, 6) + 0.0).astype(np.float32),
        np.round([p.area_m2 for p in planes], 6).astype(np.float32),
        np.ones(len(planes), bool),
    )
