"""A found model made into one of a library: canonical pose, class, planes, masses, handles."""

from __future__ import annotations

import dataclasses

import numpy as np

from ...cad_types import CadModel, held
from ...classes import class_named
from ...errors import LibraryError
from ...robot_model import RobotModel, link_transforms
from ...types import PlaneSet
from ..kit.surfaces import Plane
from ..model_files import with_content_hash
from .class_guess import OTHER, guess_class
from .found import FoundModel
from .handles import find_handles, is_handle
from .mass import with_masses
from .names import slug
from .orientation import (
    find_front,
    find_up,
    habitual_front,
    rotation_to_canonical,
)
from .placing import reversed_faces, stretched, with_root_moved
from .planes import find_planes
from .plausible import is_plausible, largest_side_range, unit_of
from .settings import DEFAULT, ConvertSettings
from .skin import Skin, skin_of
from .symmetry import symmetry_order
from .winding import find_winding

_UNKNOWN = "unknown"
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
    robot, class_name = _placed(found, class_name, settings, notes)
    robot, skin, sheet = _repaired(robot, notes)
    robot, size, shift = _centred(robot, settings, notes)
    skin = skin.shifted(shift)
    robot = _with_whole_collision(robot, notes)
    _check_joints(robot, notes)
    robot, mass_note = with_masses(robot, skin, class_name, found.mass_kg)
    notes += [mass_note] if mass_note else []
    names = tuple(link.name for link in robot.links)
    planes = find_planes(skin, sheet, names, settings, soft=class_name in _SOFT)
    mount = _mount(found, class_name, notes)
    fixed_front = bool(robot.moving_joints) or class_name in _FRONTED
    model = CadModel(
        id=f"{class_name}/{slug(found.name)}",
        class_name=class_name,
        load_robot=held(robot),
        moving_joints=tuple(joint.name for joint in robot.moving_joints),
        size=size,
        planes=_plane_set(planes),
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


def _mount(found: FoundModel, class_name: str, notes: list[str]) -> str:
    usual = class_named(class_name).mount
    if found.mount is not None:
        return found.mount
    if usual in ("floor", "surface") and (found.elevation_m or 0.0) >= _HUNG_M:
        notes.append(f"hangs {found.elevation_m:.2f} m above the floor: mounted on a wall")
        return "wall"
    return usual


def _placed(
    found: FoundModel, class_name: str, settings: ConvertSettings, notes: list[str]
) -> tuple[RobotModel, str]:
    """The robot upright, its front to -y, in metres; and the class, if its size allows it."""
    robot, skin = found.robot, skin_of(found.robot)
    if not len(skin.faces):
        raise LibraryError(f"{found.source}: all faces are empty", "export it with an area")
    up = found.up
    if up is None:
        guess = find_up(skin.vertices, found.source, class_name)
        up = guess.vector
        notes.append(guess.note)
    front = habitual_front(up) if found.front is None else found.front
    upright = with_root_moved(robot, 1.0, rotation_to_canonical(up, front), np.zeros(3))
    if found.front is None:
        upright = _faced(upright, class_name, notes)
    size = skin_of(upright).size
    if found.size_m is not None:
        return _at_stated_size(upright, size, found, class_name, settings, notes)
    unit = unit_of(float(size.max()), class_name, found.unit_m)
    if unit is None:
        low, high = largest_side_range(class_name)
        what = "thing" if class_name == OTHER else class_name
        problem = f"{found.source}: no unit of length makes a {what} of {size.max():.4g} units"
        raise LibraryError(problem, f"a {what} is {low:g} to {high:g} m large: scale it")
    notes += [unit.note] if unit.note else []
    robot = with_root_moved(upright, unit.unit_m, np.eye(3), np.zeros(3))
    _require_size(size * unit.unit_m, found, settings)
    return robot, _class_at(class_name, float(size.max() * unit.unit_m), found, notes)


def _faced(robot: RobotModel, class_name: str, notes: list[str]) -> RobotModel:
    guess = find_front(robot, skin_of(robot), class_name)
    if guess is None:
        notes.append("front assumed: the habit of its format, no sign of another")
        return robot
    turn = rotation_to_canonical(np.array([0.0, 0, 1]), guess.vector)
    notes.append(guess.note)
    return with_root_moved(robot, 1.0, turn, np.zeros(3))


def _at_stated_size(
    robot: RobotModel,
    size: np.ndarray,
    found: FoundModel,
    class_name: str,
    settings: ConvertSettings,
    notes: list[str],
) -> tuple[RobotModel, str]:
    """Stretched to its stated width, depth and height; models with joints by one factor only."""
    stated = np.asarray(found.size_m, np.float64)
    flat = size < 1e-6 * size.max()
    factors = np.where(flat, 1.0, stated / np.where(flat, 1.0, size))
    even = float(np.exp(np.mean(np.log(factors[~flat]))))
    if robot.moving_joints or np.ptp(factors[~flat]) < 1e-3 * even:
        factors = np.full(3, even)
    else:
        factors = np.where(flat, even, factors)
        difference = float(np.abs(factors / even - 1).max())
        if difference > settings.size_mismatch:
            notes.append(f"stretched to its stated size, by up to {difference:.0%} unevenly")
    result = size * factors
    off = float(np.abs(result / stated - 1)[~flat].max())
    if off > settings.size_mismatch:
        notes.append(f"stated size differs from the model's proportions by {off:.0%}")
    _require_size(result, found, settings)
    if np.ptp(factors) < 1e-3 * even:
        robot = with_root_moved(robot, even, np.eye(3), np.zeros(3))
    else:
        robot = stretched(robot, np.diag(factors))
    return robot, _class_at(class_name, float(result.max()), found, notes)


def _require_size(size_m: np.ndarray, found: FoundModel, settings: ConvertSettings) -> None:
    low, high, largest = settings.min_size_m, settings.max_size_m, float(size_m.max())
    if not low <= largest <= high:
        hint = f"models are {low:g} to {high:g} m large: state another unit or size"
        raise LibraryError(f"{found.source}: {largest:.4g} m large", hint)


def _class_at(class_name: str, side_m: float, found: FoundModel, notes: list[str]) -> str:
    """The class, unless it was guessed and the size speaks against it."""
    if found.class_name is not None or is_plausible(side_m, class_name):
        return class_name
    if class_name != OTHER:
        notes.append(f"{side_m:.3g} m is no size of a {class_name}: {OTHER}")
    return OTHER


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


def _centred(
    robot: RobotModel, settings: ConvertSettings, notes: list[str]
) -> tuple[RobotModel, np.ndarray, np.ndarray]:
    """Origin at the centre of the box, which leaves handles out; its size, and the shift."""
    body = _points(robot, handles=False)
    if not len(body):
        body = _points(robot, handles=True)
    low, high = body.min(0), body.max(0)
    size = high - low
    if size.min() < settings.min_side_m:
        notes.append(f"flat: its box is made {1000 * settings.min_side_m:g} mm thick")
    shift = -(low + high) / 2
    centred = with_root_moved(robot, 1.0, np.eye(3), shift)
    return centred, np.maximum(size, settings.min_side_m).astype(np.float32), shift


def _points(robot: RobotModel, *, handles: bool) -> np.ndarray:
    poses, found = link_transforms(robot), [np.zeros((0, 3))]
    for link in robot.links:
        T = poses[link.name]
        for visual in link.visuals:
            if handles or not (is_handle(link.name) or is_handle(visual.name)):
                used = visual.mesh.vertices[np.unique(visual.mesh.faces)].astype(np.float64)
                found.append(used @ T[:3, :3].T + T[:3, 3])
    return np.concatenate(found)


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


def _plane_set(planes: list[Plane]) -> PlaneSet:
    normal = np.array([p.normal for p in planes]).reshape(-1, 3)
    corners = np.array([p.corners for p in planes]).reshape(-1, 4, 3)
    offset = -np.einsum("pc,pkc->pk", normal, corners).mean(1)
    return PlaneSet(
        (np.round(normal, 6) + 0.0).astype(np.float32),
        (np.round(offset, 6) + 0.0).astype(np.float32),
        (np.round(corners, 6) + 0.0).astype(np.float32),
        np.round([p.area_m2 for p in planes], 6).astype(np.float32),
        np.ones(len(planes), bool),
    )
