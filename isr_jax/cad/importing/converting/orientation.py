"""Which way a model stands and faces, where its file does not say.

Up is the format's habit unless the model could not stand so; the front follows from the class: a
backrest is behind, a wall cabinet's back is flat, doors and drawers open to the front. Whatever
is estimated is said.
"""

from __future__ import annotations

import dataclasses
from pathlib import PurePath

import numpy as np
from jaxtyping import Float
from scipy.spatial import ConvexHull, QhullError

from ....robot_model import Joint, Link, RobotModel, joint_motion, link_transforms
from .skin import Skin

Vector = Float[np.ndarray, "3"]

_Z_UP = (".stl", ".ply", ".urdf", ".xml", ".mjcf")
"""Formats in which z mostly points up; OBJ, GLB and the rest are mostly y up."""
_BACKREST = frozenset(["chair", "bench", "sofa", "toilet", "sink", "bed", "laptop"])
"""Their upper part is at the back."""
_UPPER = {"bed": 0.7, "sink": 0.8}
"""Where the upper part begins, as a share of the height; 0.6 by default."""
_FLAT_BACK = frozenset(
    [
        "cabinet",
        "wall_cabinet",
        "drawer_unit",
        "wardrobe",
        "nightstand",
        "bookshelf",
        "fridge",
        "oven",
        "dishwasher",
        "washing_machine",
        "microwave",
        "desk",
        "counter",
        "door",
        "window",
        "picture",
        "mirror",
        "clock",
    ]
)
_HUNG = frozenset(["toilet", "sink"])
_FLAT_FRONT = frozenset(["monitor"])
_MIN_LEAN = 0.06
"""Of the depth: an upper part that is less off the middle says nothing."""
_MIN_DIFFERENCE = 0.12
"""Of a side's area: sides that are covered more alike say nothing."""
_STEADY_SHARE = 0.15
"""A base that covers less of the footprint is no base, if another covers ..."""
_STEADIER_SHARE = 0.6
_BASE_LAYER = 0.01
_GRID = 24
_WIDER = 1.2
_PANEL_SHARE = 0.25


@dataclasses.dataclass(frozen=True, eq=False)
class Direction:
    """A direction in the file's frame, and what was assumed about it (empty: it was stated)."""

    vector: Vector
    note: str


def habitual_up(source: str) -> int:
    """Axis (0, 1, 2) that mostly points up in files of this kind."""
    names = [PurePath(part).suffix.lower() for part in source.replace(":", "/").split("/")]
    endings = [name for name in names if name]
    return 2 if endings and endings[-1] in _Z_UP else 1


def find_up(points: Float[np.ndarray, "points 3"], source: str, class_name: str) -> Direction:
    """Up of a model whose file does not state it: the format's habit, if it can stand so.

    What has a flat back would lie on it steadily, so for that the habit holds.
    """
    axis = habitual_up(source)
    habit = np.eye(3)[axis]
    other = np.eye(3)[3 - axis]
    steady = {0: base_share(points, habit), 1: base_share(points, other)}
    may_lie = class_name in _FLAT_BACK or class_name in _HUNG
    if not may_lie and steady[0] < _STEADY_SHARE and steady[1] > _STEADIER_SHARE:
        note = f"up estimated: {_axis_name(other)}, on which it stands steadily"
        return Direction(other, f"{note} (it could not stand on {_axis_name(-habit)})")
    return Direction(habit, f"up assumed: {_axis_name(habit)}, the habit of its format")


def base_share(points: Float[np.ndarray, "points 3"], up: Vector) -> float:
    """Part of the footprint's hull that the hull of its lowest layer covers."""
    along = points @ up
    rest = points[:, np.abs(up) < 0.5]
    layer = rest[along <= along.min() + _BASE_LAYER * np.ptp(along)]
    whole = _hull_area(rest)
    return _hull_area(layer) / whole if whole > 0 else 0.0


def _hull_area(points: np.ndarray) -> float:
    try:
        return float(ConvexHull(points).volume)
    except (QhullError, ValueError):
        return 0.0


def habitual_front(up: Vector) -> Vector:
    """Front by habit: -y where z is up, +z where y is up (glTF says so), else the next axis."""
    axis = int(np.argmax(np.abs(up)))
    return {0: np.array([0.0, 0, 1]), 1: np.array([0.0, 0, 1]), 2: np.array([0.0, -1, 0])}[axis]


def rotation_to_canonical(up: Vector, front: Vector) -> Float[np.ndarray, "3 3"]:
    """Rotation that takes ``up`` to +z and ``front``, made level, to -y."""
    z = up / np.linalg.norm(up)
    level = front - (front @ z) * z
    if np.linalg.norm(level) < 1e-6:
        level = np.roll(z, 1) - (np.roll(z, 1) @ z) * z
    y = -level / np.linalg.norm(level)
    return np.stack([np.cross(y, z), y, z])


def find_front(robot: RobotModel, skin: Skin, class_name: str) -> Direction | None:
    """Front of an upright model from its moving parts, backrest or flat back; None: no sign.

    Args:
        robot: z up.
        skin: Of that robot.
    """
    moved = _opening_direction(robot)
    if moved is not None:
        return Direction(moved, f"front estimated: {_axis_name(moved)}, where its parts open to")
    if class_name in _BACKREST:
        lean = _upper_part(skin, _UPPER.get(class_name, 0.6))
        if lean is not None:
            return Direction(-lean, f"front estimated: {_axis_name(-lean)}, away from its back")
    if class_name in _FLAT_BACK or class_name in _FLAT_FRONT:
        flat = _flattest_side(skin)
        if flat is not None:
            front = flat if class_name in _FLAT_FRONT else -flat
            side = "its flat side" if class_name in _FLAT_FRONT else "away from its flat back"
            return Direction(front, f"front estimated: {_axis_name(front)}, {side}")
    return None


def _opening_direction(robot: RobotModel) -> Vector | None:
    """Level axis along which most of the moving links go when their joints start to open."""
    votes, closed = np.zeros(3), link_transforms(robot)
    for joint in robot.moving_joints:
        link = robot.link(joint.child)
        if not link.visuals:
            continue
        points = np.concatenate([v.mesh.vertices for v in link.visuals]).astype(np.float64)
        far = joint.upper if abs(joint.upper) >= abs(joint.lower) else joint.lower
        step = np.sign(far) * min(abs(far), 0.2)
        if joint.kind == "continuous" or step == 0 or _slides_sideways(joint, link):
            continue
        T = closed[joint.child]
        middle = np.append((points.min(0) + points.max(0)) / 2, 1.0)
        travel = (T @ joint_motion(joint, step) @ middle - T @ middle)[:3]
        votes += travel * np.prod(np.sort(np.ptp(points, axis=0))[1:])
    return _level_axis(votes) if np.linalg.norm(votes[:2]) > 1e-9 else None


def _slides_sideways(joint: Joint, link: Link) -> bool:
    """Whether a thin panel moves in its own plane: a sliding door says nothing of the front."""
    extents = np.array([np.ptp(v.mesh.vertices, axis=0) for v in link.visuals])
    largest = extents[np.argmax(np.prod(np.sort(extents, axis=1)[:, 1:], axis=1))]
    thin = int(np.argmin(largest))
    is_panel = largest[thin] < _PANEL_SHARE * np.sort(largest)[1]
    return bool(joint.kind == "prismatic" and is_panel and abs(joint.axis[thin]) < 0.5)


def _upper_part(skin: Skin, share: float) -> Vector | None:
    """Level axis towards which the upper part of a model lies, None where it is in the middle."""
    center = skin.corners.mean(1)
    low, high = skin.vertices.min(0), skin.vertices.max(0)
    upper = center[:, 2] > low[2] + share * (high[2] - low[2])
    if not upper.any():
        return None
    middle = np.average(center[upper], axis=0, weights=skin.area[upper])
    lean = (middle - (low + high) / 2)[:2] / np.maximum(high - low, 1e-9)[:2]
    best = int(np.argmax(np.abs(lean)))
    if abs(lean[best]) < _MIN_LEAN:
        return None
    return np.sign(lean[best]) * np.eye(3)[best]


def _flattest_side(skin: Skin) -> Vector | None:
    """Level axis of the side that lies in one plane more than the opposite one does."""
    shares = side_flatness(skin)
    difference = shares - shares[[1, 0, 3, 2]]
    x, y, _ = skin.size
    # Nearly all such things are wider than deep: their narrow sides are neither front nor back.
    if max(x, y) > _WIDER * min(x, y):
        difference[slice(0, 2) if x > y else slice(2, 4)] = 0.0
    best = int(np.argmax(difference))
    if difference[best] < _MIN_DIFFERENCE:
        return None
    return np.array([1.0, -1.0, 1.0, -1.0])[best] * np.eye(3)[best // 2]


def side_flatness(skin: Skin) -> Float[np.ndarray, "4"]:
    """Part of each side of the box, +x -x +y -y, behind which the surface lies at once.

    Rays from outside see it within 2 % of the depth.
    """
    low, high = skin.vertices.min(0), skin.vertices.max(0)
    size = np.maximum(high - low, 1e-9)
    steps = (np.arange(_GRID) + 0.5) / _GRID
    shares = []
    for axis, sign in ((0, 1), (0, -1), (1, 1), (1, -1)):
        other = 1 - axis
        a, b = np.meshgrid(low[other] + size[other] * steps, low[2] + size[2] * steps)
        origins = np.zeros((a.size, 3))
        origins[:, other], origins[:, 2] = a.ravel(), b.ravel()
        origins[:, axis] = (high if sign > 0 else low)[axis] + sign * size[axis]
        direction = np.tile(-sign * np.eye(3)[axis], (a.size, 1))
        hits = skin.rays.cast(origins, direction)
        near = (hits.triangle >= 0) & (hits.distance <= 1.02 * size[axis])
        shares.append(near.mean())
    return np.array(shares)


def _level_axis(vector: np.ndarray) -> Vector:
    best = int(np.argmax(np.abs(vector[:2])))
    return np.sign(vector[best]) * np.eye(3)[best]


def _axis_name(vector: np.ndarray) -> str:
    best = int(np.argmax(np.abs(vector)))
    return f"{'-' if vector[best] < 0 else '+'}{'xyz'[best]}"
