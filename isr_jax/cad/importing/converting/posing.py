"""A found model brought into the canonical pose: upright, facing -y, in metres, centred."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool

from ....errors import LibraryError
from ....robot_model import RobotModel
from ..found import FoundModel
from .class_guess import OTHER
from .handles import is_handle
from .orientation import find_front, find_up, habitual_front, rotation_to_canonical
from .placing import stretched, with_root_moved
from .plausible import is_plausible, largest_side_range, unit_of
from .settings import ConvertSettings
from .skin import Skin, skin_of


def posed(
    found: FoundModel, class_name: str, settings: ConvertSettings, notes: list[str]
) -> tuple[RobotModel, str]:
    """The robot upright, its front to -y, in metres; and the class, if its size allows it.

    What was estimated is added to ``notes``.

    Raises:
        LibraryError: its faces have no area, or no unit makes its size plausible.
    """
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


def body_faces(robot: RobotModel, skin: Skin) -> Bool[np.ndarray, " faces"]:
    """Faces that make the box and carry: all but those named handles, if others are left."""
    handle = [
        is_handle(link.name) or is_handle(visual.name)
        for link in robot.links
        for visual in link.visuals
    ]
    body = ~np.array(handle, bool)[skin.visual]
    return body if body.any() else np.ones(len(body), bool)


def centred(
    robot: RobotModel,
    skin: Skin,
    body: Bool[np.ndarray, " faces"],
    settings: ConvertSettings,
    notes: list[str],
) -> tuple[RobotModel, Skin, np.ndarray]:
    """Robot and skin with the origin at the centre of the box, and the size of the box."""
    corners = skin.corners[body].reshape(-1, 3)
    low, high = corners.min(0), corners.max(0)
    size = high - low
    if size.min() < settings.min_side_m:
        notes.append(f"flat: its box is made {1000 * settings.min_side_m:g} mm thick")
    shift = -(low + high) / 2
    size = np.maximum(size, settings.min_side_m).astype(np.float32)
    return with_root_moved(robot, 1.0, np.eye(3), shift), skin.shifted(shift), size
