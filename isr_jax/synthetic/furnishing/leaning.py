"""What leans: tilted back until its upper edge touches a wall, its lower edge on what it stands on.

A plate of height h and thickness t that is tilted by a from the upright stands on its lower back
edge and touches the wall with its upper back edge. It falls back against the wall and not into
the room where its centre of mass lies behind the lower edge: h sin a > t cos a. With friction
only on the floor it stays while tan(a) / 2 is less than the coefficient (moments about the upper
edge), at 15 degrees 0.13.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float

from ...library import CadModel
from .floor_rules import WALL_YAWS
from .placement import TRIES, Occupancy
from .proposal import ON_FLOOR, Proposal, rotation_2d
from .recipe import LeanOnTop, LeanOnWall
from .stock import Stock, center_of_mass
from .support_rules import clear_of_carriers, plane_height_m
from .tops import carrying_planes, ray_scene, top_of

TILTS_RAD = (np.radians(8.0), np.radians(15.0))
_SPARE_M = 0.004
"""Least distance of the centre of mass behind the edge that it stands on."""
_CONTACT_M = 3e-4
_CONTACT_SHARE = 0.5
"""Of its width that touches, below and above."""
_THIN = 0.3
"""Thickness by height above which nothing leans at these tilts."""
_EDGE_M = 0.012
_REACH_M = 1.4
_SIDE_RAYS = 5


@dataclasses.dataclass(frozen=True, eq=False)
class _Leaned:
    """A model tilted towards +y."""

    R: Float[np.ndarray, "3 3"]
    size: Float[np.ndarray, "3"]
    """Of the box around it, metres."""
    low: Float[np.ndarray, "3"]
    """Lowest corner of that box, seen from the model's origin."""
    foot: Float[np.ndarray, "feet 3"]
    """Vertices on which it stands, from the origin."""
    touch_m: float
    """Height of the edge that touches the wall, above the feet."""


def lean_on_walls(
    space: Occupancy, stock: Stock, rng: np.random.Generator, step: LeanOnWall
) -> None:
    """Flat things on the floor that lean on walls."""
    for _ in range(int(rng.integers(step.count[0], step.count[1] + 1))):
        proposals: list[Proposal] = []
        drawn = _draw(stock, rng, step.roles)
        if drawn is None:
            return
        role, model, scale, leaned = drawn
        for _ in range(TRIES):
            wall = int(rng.integers(4))
            along = float(rng.uniform(-1, 1) * (space.half[wall % 2] - leaned.size[0] / 2 - 0.03))
            center = _against_wall(space, leaned, wall, along, 0.0)
            proposals.append(
                Proposal(
                    model,
                    scale,
                    WALL_YAWS[wall],
                    center,
                    ON_FLOOR,
                    attachment="leaning",
                    lean=leaned.R,
                    role=role,
                )
            )
        space.add_first(proposals)


def lean_on_tops(space: Occupancy, stock: Stock, rng: np.random.Generator, step: LeanOnTop) -> None:
    """Flat things on furniture that lean on a side of it, or on the wall at its back."""
    hosts = space.positions(*step.hosts)
    for _ in range(int(rng.integers(step.count[0], step.count[1] + 1))):
        drawn = _draw(stock, rng, step.roles)
        if drawn is not None:
            _lean_on_any(space, rng, hosts, *drawn)


def _lean_on_any(
    space: Occupancy,
    rng: np.random.Generator,
    hosts: list[int],
    role: str,
    model: CadModel,
    scale: float,
    leaned: _Leaned,
) -> int | None:
    for host in rng.permutation(np.asarray(hosts, int)):
        under = space.placed[host]
        for plane in rng.permutation(carrying_planes(under.model)):
            if plane_height_m(under, int(plane)) > _REACH_M:
                continue
            places = [
                *_against_sides(under, int(plane), leaned, rng),
                *_against_room(space, under, int(plane), leaned, rng),
            ]
            proposals = [
                Proposal(
                    model,
                    scale,
                    yaw,
                    center,
                    int(host),
                    int(plane),
                    attachment="leaning",
                    lean=leaned.R,
                    role=role,
                )
                for yaw, center in places
            ]
            clear = [p for p in proposals if clear_of_carriers(space, p, -_SPARE_M)]
            position = space.add_first(clear)
            if position is not None:
                return position
    return None


def _draw(
    stock: Stock, rng: np.random.Generator, roles: tuple[str, ...]
) -> tuple[str, CadModel, float, _Leaned] | None:
    """A model of the roles that can lean, and how it does."""
    for role in roles:
        found = stock.pick(role, lambda model: _leaned(model, 1.0, TILTS_RAD[1]) is not None)
        if found is None:
            continue
        for tilt in sorted(rng.uniform(*TILTS_RAD, 4)):
            leaned = _leaned(*found, float(tilt))
            if leaned is not None:
                return role, *found, leaned
    return None


def _leaned(model: CadModel, scale: float, tilt_rad: float) -> _Leaned | None:
    """The tilted model; None where it would not stay, or touches with a point only."""
    order = np.argsort(np.asarray(model.size, np.float64), kind="stable")
    thin = int(order[0])
    up = 2 if thin != 2 else int(order[2])
    if model.size[thin] > _THIN * model.size[up]:
        return None
    c, s = np.cos(tilt_rad), np.sin(tilt_rad)
    R = np.array([[1, 0, 0], [0, c, s], [0, -s, c]]) @ _upended(thin, up)
    points = scale * model.mesh.vertices.astype(np.float64) @ R.T
    low, high = points.min(0), points.max(0)
    feet = points[points[:, 2] < low[2] + _CONTACT_M]
    upper = points[points[:, 1] > high[1] - _CONTACT_M]
    middle = scale * R @ center_of_mass(model)
    least = _CONTACT_SHARE * (high[0] - low[0])
    stays = middle[1] > feet[:, 1].max() + _SPARE_M and middle[1] < high[1] - _SPARE_M
    for edge in (feet, upper):
        stays &= np.ptp(edge[:, 0]) > least
        stays &= bool(edge[:, 0].min() < middle[0] < edge[:, 0].max())
    if not stays:
        return None
    return _Leaned(R, high - low, low, feet, float(upper[:, 2].max() - low[2]))


def _upended(thin: int, up: int) -> np.ndarray:
    """Rotation that turns axis ``thin`` to -y or y and ``up`` to z; what was up faces the room."""
    R = np.zeros((3, 3))
    R[2, up] = 1.0
    R[1, thin] = -1.0 if thin == 2 else 1.0
    R[0] = np.cross(R[1], R[2])
    return R


def _against_wall(
    space: Occupancy, leaned: _Leaned, wall: int, along: float, floor_m: float
) -> np.ndarray:
    """Centre in the room of what leans on wall 0..3 and stands at a height."""
    outward = np.array([(0, 1), (1, 0), (0, -1), (-1, 0)])[wall]
    back = float(leaned.low[1] + leaned.size[1])
    place = outward * (float(space.half[1 - wall % 2]) - back)
    place = place + np.abs(outward[::-1]) * along
    return np.array([*place, floor_m - float(leaned.low[2])])


def _against_room(
    space: Occupancy, under: Proposal, plane: int, leaned: _Leaned, rng: np.random.Generator
) -> list[tuple[float, np.ndarray]]:
    """On a top, leaning on the wall at the host's back: (yaw, centre)."""
    wall = int(np.argmax([np.cos(under.yaw - yaw) for yaw in WALL_YAWS]))
    if abs(np.sin(under.yaw - WALL_YAWS[wall])) > 1e-6:
        return []
    top, height = top_of(under.model, plane), plane_height_m(under, plane)
    found = []
    for _ in range(TRIES):
        share = float(rng.uniform(top.low[0], top.high[0])) * under.scale
        along = (under.center[:2] + rotation_2d(under.yaw) @ np.array([share, 0.0]))[wall % 2]
        center = _against_wall(space, leaned, wall, float(along), height)
        if _stands_on(under, plane, leaned, WALL_YAWS[wall], center):
            found.append((WALL_YAWS[wall], center))
    return found


def _against_sides(
    under: Proposal, plane: int, leaned: _Leaned, rng: np.random.Generator
) -> list[tuple[float, np.ndarray]]:
    """On a shelf, leaning on one of its sides, which rays at the touching height find."""
    top = top_of(under.model, plane)
    found = []
    middle, half = (top.low + top.high) / 2, (top.high - top.low) / 2
    for sign in rng.permutation([1.0, -1.0]):
        depth = leaned.size[0] / under.scale / 2
        spare = half[1] - depth - _EDGE_M
        if spare < 0:
            continue
        y = middle[1] + float(rng.uniform(-1, 1)) * spare
        x = float(rng.uniform(-0.9, 0.9)) * half[0] + middle[0]
        reach = _side_at(
            under.model, np.array([x, y]), top.height_m, sign, depth, leaned.touch_m / under.scale
        )
        if reach is None:
            continue
        # The wall of the tilted frame, at +y, is the side: -90 degrees about z for +x.
        yaw = under.yaw - sign * np.pi / 2
        back = float(leaned.low[1] + leaned.size[1])
        local = np.array([under.scale * (x + sign * reach) - sign * back, under.scale * y])
        place = under.center[:2] + rotation_2d(under.yaw) @ local
        center = np.array([*place, plane_height_m(under, plane) - float(leaned.low[2])])
        if _stands_on(under, plane, leaned, float(yaw), center):
            found.append((float(yaw), center))
    return found


def _side_at(
    model: CadModel, at: np.ndarray, height: float, sign: float, depth: float, touch: float
) -> float | None:
    """Distance along x to an upright side over the whole depth of a thing, or None."""
    y = at[1] + np.linspace(-depth, depth, _SIDE_RAYS)
    origins = np.stack([np.full(len(y), at[0]), y, np.full(len(y), height + touch)], 1)
    hits = ray_scene(model).cast(origins, np.tile([sign, 0.0, 0.0], (len(y), 1)))
    flat = np.ptp(hits.distance) < 1e-4 and np.all(np.abs(hits.normal[:, 0]) > 0.999)
    return float(hits.distance.mean()) if np.all(hits.instance > 0) and flat else None


def _stands_on(
    under: Proposal, plane: int, leaned: _Leaned, yaw: float, center: np.ndarray
) -> bool:
    """Whether its whole lower edge, and a little around it, lies on the plane."""
    feet = leaned.foot[:, :2]
    around = np.array([0.0, 2 * _EDGE_M / 3])
    low, high = feet.min(0) - around, feet.max(0) + around
    share = np.linspace(0, 1, 9)
    x, y = np.meshgrid(low[0] + share * (high[0] - low[0]), [low[1], high[1]])
    room = np.stack([x.ravel(), y.ravel()], 1) @ rotation_2d(yaw).T + center[:2]
    local = (room - under.center[:2]) @ rotation_2d(under.yaw) / under.scale
    return top_of(under.model, plane).carries(local)
