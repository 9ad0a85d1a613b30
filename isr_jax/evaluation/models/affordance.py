"""What a thing offers: parts that move, places that carry, room that opens."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np
from jaxtyping import Float
from scipy.optimize import linear_sum_assignment

from ...config import DEFAULT_SUPPORT, SupportSettings
from ...robot_model import Joint, Link, link_transforms
from ...scene_file import EntityRecord
from .cad_cases import PosedModel

AXIS_RAD = float(np.deg2rad(20.0))
PLACE_M = 0.2
"""Axis and place of a moving part count up to the limits of an aligned CAD."""
SIDE_RAD = float(np.deg2rad(45.0))
"""A part opens to the same side where its first motion differs by less."""
HEIGHT_M = 0.05
"""A plane carries what stands higher or lower by no more than this."""
_SEAT_M2 = 0.02
"""A supporting plane of at least this area offers a place even where nothing stands on it."""
_EMPTY_M3 = 1e-6
_ARM_M = 0.005
"""What turns about its own middle opens to no side."""


@dataclasses.dataclass(frozen=True, eq=False)
class MovingPart:
    """A joint and what it moves, world frame, closed."""

    slides: bool
    axis: Float[np.ndarray, "3"]
    """Unit; along it (slide) or about it (hinge) the part opens."""
    opens_to: Float[np.ndarray, "3"]
    """Unit, the way on which its middle sets out; 0 for what turns about its middle."""
    endless: bool
    """Without limits: it turns either way."""
    place: Float[np.ndarray, "3"]
    """Middle of the box about the part, metres."""
    opens_m3: float
    """Room that it opens."""


def moving_parts(posed: PosedModel) -> tuple[MovingPart, ...]:
    """The parts that move, in the order of the joints.

    The room that a drawer opens is its cross-section times its travel; that behind a door, lid or
    flap is its panel (the two long sides of its box) times the depth of the model behind it. Knobs
    and wheels turn without limits and open nothing.
    """
    poses = link_transforms(posed.model.robot)
    return tuple(
        _part(posed, joint, np.asarray(poses[joint.child], np.float64))
        for joint in posed.model.robot.moving_joints
    )


def _part(posed: PosedModel, joint: Joint, T: Float[np.ndarray, "4 4"]) -> MovingPart:
    """One moving part; ``T`` brings its link to the model's frame, closed."""
    low, high = _bounds(posed.model.robot.link(joint.child), T)
    sense = 1.0 if abs(joint.upper) >= abs(joint.lower) else -1.0
    axis = sense * T[:3, :3] @ np.asarray(joint.axis, np.float64)
    slides = joint.kind == "prismatic"
    arm = (low + high) / 2 - T[:3, 3]
    way = axis if slides else np.cross(axis, arm)
    length = float(np.linalg.norm(way))
    opens = joint.kind != "continuous" and length > _ARM_M
    return MovingPart(
        slides=slides,
        axis=posed.rotation @ axis,
        opens_to=posed.rotation @ way / length if opens else np.zeros(3),
        endless=joint.kind == "continuous",
        place=posed.to_world((low + high)[None] / 2)[0],
        opens_m3=_opens_m3(posed, joint, axis, high - low),
    )


def _bounds(link: Link, T: Float[np.ndarray, "4 4"]) -> tuple[np.ndarray, np.ndarray]:
    """Of what is seen of a link, in another frame; its origin where nothing is."""
    points = [v.mesh.vertices for v in link.visuals if len(v.mesh.vertices)]
    joined = np.concatenate([*points] if points else [np.zeros((1, 3))])
    moved = joined @ T[:3, :3].T + T[:3, 3]
    return moved.min(0), moved.max(0)


def _opens_m3(posed: PosedModel, joint: Joint, axis: np.ndarray, size: np.ndarray) -> float:
    scale = float(np.prod(posed.scale))
    if joint.kind == "prismatic":
        along = int(np.argmax(np.abs(axis)))
        front = np.delete(size, along).prod()
        return float(front * abs(joint.upper - joint.lower)) * scale
    if joint.kind == "revolute":
        thin = int(np.argmin(size))
        return float(np.delete(size, thin).prod() * np.asarray(posed.model.size)[thin]) * scale
    return 0.0


def joint_agreement(true: Sequence[MovingPart], placed: Sequence[MovingPart]) -> float | None:
    """2 sum_(t,p) c(t, p) / (joints of both), over the best one-to-one assignment; None if none.

    c is 0 for a slide against a hinge, else 0.5, and 0.25 more each for a part within 20 cm, and
    for an axis within 20 degrees about or along which it opens to the same side (a door hung on
    the other edge, or on another face, is another door).
    """
    if not true and not placed:
        return None
    credit = np.array([[_credit(t, p) for p in placed] for t in true]).reshape(
        len(true), len(placed)
    )
    rows, columns = linear_sum_assignment(credit, maximize=True)
    return float(2 * credit[rows, columns].sum() / (len(true) + len(placed)))


def _credit(t: MovingPart, p: MovingPart) -> float:
    if t.slides != p.slides:
        return 0.0
    cosine = float(t.axis @ p.axis)
    if t.endless or p.endless:
        cosine = abs(cosine)
    axis = np.arccos(np.clip(cosine, -1, 1)) <= AXIS_RAD
    if t.opens_to.any() and p.opens_to.any():
        axis = axis and float(t.opens_to @ p.opens_to) >= np.cos(SIDE_RAD)
    place = np.linalg.norm(t.place - p.place) <= PLACE_M
    return 0.5 + 0.25 * bool(axis) + 0.25 * bool(place)


def volume_agreement(true: Sequence[MovingPart], placed: Sequence[MovingPart]) -> float | None:
    """Cube root of smaller over larger of the rooms that both open, a ratio of lengths as the
    limits of size are; None where the true one opens none."""
    a, b = (sum(part.opens_m3 for part in parts) for parts in (true, placed))
    return None if a < _EMPTY_M3 else float(np.cbrt(min(a, b) / max(a, b)))


def carrying_planes(
    found: EntityRecord,
    placed: PosedModel | None,
    T: Float[np.ndarray, "4 4"],
    support: SupportSettings = DEFAULT_SUPPORT,
) -> Float[np.ndarray, "planes 4 3"]:
    """Rectangles that may carry something, world of the truth: of the model, else of the scan.

    Args:
        found: The entity.
        placed: The model that stands for it, already in the truth's world.
        T: From the result's world to the truth's.
        support: What faces up (a_th).
    """
    if placed is not None:
        return supporting_rectangles(placed, support)
    up = [p.corners for p in found.planes if p.normal[2] >= support.up_cosine]
    corners = np.array(up, np.float64).reshape(-1, 4, 3)
    return corners @ T[:3, :3].T + T[:3, 3]


def supporting_rectangles(
    posed: PosedModel, support: SupportSettings = DEFAULT_SUPPORT
) -> Float[np.ndarray, "planes 4 3"]:
    """The supporting planes of a model where it stands, those that still face up (a_th)."""
    planes = posed.model.planes
    rows = np.asarray(posed.model.plane_supporting) & np.asarray(planes.valid)
    rows &= np.asarray(planes.normal, np.float64) @ posed.rotation[2] >= support.up_cosine
    corners = np.asarray(planes.corners)[rows].reshape(-1, 3)
    return posed.to_world(corners).reshape(-1, 4, 3)


def asked_places(
    true: PosedModel,
    children: Sequence[EntityRecord],
    support: SupportSettings = DEFAULT_SUPPORT,
) -> Float[np.ndarray, "places 3"]:
    """Where something must find a hold: below every true child, and on the largest supporting
    plane (a seat, a table top), if it is not too small."""
    places = []
    for child in children:
        center, size = np.asarray(child.box.center), np.asarray(child.box.size)
        places.append([center[0], center[1], center[2] - size[2] / 2])
    rectangles = supporting_rectangles(true, support)
    sides = rectangles[:, 1] - rectangles[:, 0], rectangles[:, 3] - rectangles[:, 0]
    area = np.linalg.norm(np.cross(sides[0], sides[1]), axis=-1)
    if len(area) and area.max() >= _SEAT_M2:
        places.append(rectangles[int(np.argmax(area))].mean(0))
    return np.array(places, np.float64).reshape(-1, 3)


def carrying_agreement(
    places: Float[np.ndarray, "places 3"], rectangles: Float[np.ndarray, "planes 4 3"]
) -> float | None:
    """Share of the places with a rectangle below or above within 5 cm; None without places."""
    if len(places) == 0:
        return None
    return float(np.mean([any(_holds(r, place) for r in rectangles) for place in places]))


def _holds(rectangle: np.ndarray, place: np.ndarray) -> bool:
    """Whether a place lies over a rectangle (grown by 5 cm on each side) at its height."""
    offset = place - rectangle[0]
    for side in (rectangle[1] - rectangle[0], rectangle[3] - rectangle[0]):
        length = float(np.linalg.norm(side))
        along = float(offset @ side) / max(length, 1e-9)
        if not -HEIGHT_M <= along <= length + HEIGHT_M:
            return False
    return bool(abs(rectangle.mean(0)[2] - place[2]) <= HEIGHT_M)
