"""The way of a hand-held camera through a room: views that show it, joined to a smooth walk."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float
from scipy.interpolate import PchipInterpolator
from scipy.ndimage import gaussian_filter1d

from ...borders.raycast import RayScene
from ...config import NoiseModel
from ...types import Camera
from ..room import Room
from ..surface import room_surfaces
from .cameras import default_camera
from .free_space import CLEAR_M, FreeSpace, clearance_m, free_space, inside_room, route
from .viewpoints import Viewpoints, choose_viewpoints, directions, look_along
from .visibility import room_samples

_SPEED_M, _TURN_RAD = 0.12, 0.21
"""A frame, at which neighbouring frames still show much the same: 12 cm, 12 degrees."""
_FEWEST_VIEWS, _MOST_VIEWS = 8, 60
_PER_METRE = 8
"""Points of the smooth way at which it is checked, and made from."""
_INSIDE_M = 0.3
"""From walls, floor and ceiling."""
_TREMOR_M, _TREMOR_RAD = 0.004, 0.006


def camera_path(
    room: Room,
    frames: int,
    seed: int,
    *,
    camera: Camera | None = None,
    sensor: NoiseModel = NoiseModel(),  # noqa: B008 (frozen)
) -> Float[np.ndarray, "frames 4 4"]:
    """``T_world_camera`` of each frame, float64.

    Views are chosen that show three quarters of what can be seen of each thing (a greedy cover,
    `choose_viewpoints`), as many as can be walked in the frames at a comfortable speed; they are
    ordered to a short round, joined by ways that keep clear of everything, and smoothed, with the
    slow tremor of a hand on top.

    Args:
        room: With its furniture.
        frames: Length of the film; few frames see less, and move faster.
        seed: Another one walks another way.
        camera: Its field of view counts; None: a Kinect's.
        sensor: Its range counts.

    Raises:
        SceneError: there is nowhere to stand.
    """
    rng = np.random.default_rng([seed, 1])
    surfaces = room_surfaces(room)
    scene = RayScene([s.mesh for s in surfaces.values()], list(surfaces))
    ceilings = {patch.id for patch in room.layout if patch.class_name == "ceiling"}
    samples = room_samples({i: s for i, s in surfaces.items() if i not in ceilings})
    space = free_space(room, seed)
    views = choose_viewpoints(
        scene,
        samples,
        space,
        camera or default_camera(640, 480),
        sensor,
        at_most=_MOST_VIEWS,
        rng=rng,
    )
    views, order = _round_that_fits(space, views, frames)
    return _film(room, _keys(room, space, _rows(views, order)), frames, rng)


def _rows(views: Viewpoints, rows: np.ndarray) -> Viewpoints:
    return Viewpoints(*(getattr(views, f.name)[rows] for f in dataclasses.fields(views)))


def _round_that_fits(
    space: FreeSpace, views: Viewpoints, frames: int
) -> tuple[Viewpoints, np.ndarray]:
    """The first views, as many as the frames suffice for, and the order to visit them in."""
    count = len(views.eye)
    while True:
        views = _rows(views, np.arange(count))
        cost = _frames_between(space, views)
        order = _short_round(cost)
        needed = float(cost[order[:-1], order[1:]].sum())
        if needed <= frames or count <= _FEWEST_VIEWS:
            return views, order
        count = max(_FEWEST_VIEWS, min(count - 1, int(count * frames / needed)))


def _frames_between(space: FreeSpace, views: Viewpoints) -> Float[np.ndarray, "views views"]:
    """At a comfortable speed."""
    way = space.length_m[np.ix_(views.eye, views.eye)] / _SPEED_M
    forward = directions(views.heading, views.pitch)
    turn = np.arccos(np.clip(forward @ forward.T, -1, 1)) / _TURN_RAD
    return np.maximum(np.maximum(way, turn), 1.0)


def _short_round(cost: np.ndarray) -> np.ndarray:
    """An order of little cost from the first view: the nearest next, then 2-opt."""
    left, order = list(range(1, len(cost))), [0]
    while left:
        order.append(left.pop(int(np.argmin(cost[order[-1], left]))))
    best = np.array(order)
    for _ in range(len(cost)):
        gain, i, j = _best_reversal(cost, best)
        if gain <= 1e-9:
            break
        best[i : j + 1] = best[i : j + 1][::-1]
    return best


def _best_reversal(cost: np.ndarray, order: np.ndarray) -> tuple[float, int, int]:
    """What reversing ``order[i : j + 1]`` saves at most."""
    i, j = np.triu_indices(len(order), 1)
    i, j = i[i > 0], j[i > 0]
    if not len(i):
        return 0.0, 0, 0
    last = j == len(order) - 1
    after = order[np.minimum(j + 1, len(order) - 1)]
    before, first, end = order[i - 1], order[i], order[j]
    saved = cost[before, first] - cost[before, end]
    saved = saved + np.where(last, 0, cost[end, after] - cost[first, after])
    best = int(np.argmax(saved))
    return float(saved[best]), int(i[best]), int(j[best])


@dataclasses.dataclass(frozen=True, eq=False)
class _Keys:
    """Corners of the way and the directions of the views, each with its time."""

    eye: Float[np.ndarray, "corners 3"]
    eye_time: Float[np.ndarray, " corners"]
    heading: Float[np.ndarray, " views"]
    """Unwrapped, radians."""
    pitch: Float[np.ndarray, " views"]
    time: Float[np.ndarray, " views"]


def _keys(room: Room, space: FreeSpace, views: Viewpoints) -> _Keys:
    heading = np.unwrap(views.heading)
    corners, corner_time = [space.eyes[views.eye[0]]], [0.0]
    times = [0.0]
    for k in range(1, len(views.eye)):
        points = route(room, space, int(views.eye[k - 1]), int(views.eye[k]))
        steps = np.linalg.norm(np.diff(points, axis=0), axis=1)
        turn = max(abs(heading[k] - heading[k - 1]), abs(views.pitch[k] - views.pitch[k - 1]))
        lasts = max(steps.sum() / _SPEED_M, turn / _TURN_RAD, 1.0)
        passed = np.cumsum(steps) / max(steps.sum(), 1e-9)
        moves = len(points) > 1 and steps.sum() > 0
        corners += list(points[1:]) if moves else [points[-1]]
        corner_time += list(times[-1] + lasts * passed) if moves else [times[-1] + lasts]
        times.append(times[-1] + lasts)
    return _Keys(np.array(corners), np.array(corner_time), heading, views.pitch, np.array(times))


def _film(room: Room, keys: _Keys, frames: int, rng: np.random.Generator) -> np.ndarray:
    at = np.linspace(0, keys.time[-1], frames)
    way = _smooth_way(room, keys)
    eye = np.stack([np.interp(at, *_track(keys, way[:, k])) for k in range(3)], 1)
    tremor = _tremor(rng, frames, _TREMOR_RAD)
    heading = _turned(keys, keys.heading, at) + tremor[:, 0]
    pitch = _turned(keys, keys.pitch, at) + tremor[:, 1]
    eye = eye + _tremor(rng, frames, _TREMOR_M)
    forward = directions(heading, pitch)
    return np.stack([look_along(e, f) for e, f in zip(eye, forward, strict=True)])


def _track(keys: _Keys, values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    return np.linspace(0, keys.time[-1], len(values)), values


def _turned(keys: _Keys, angle: np.ndarray, at: np.ndarray) -> np.ndarray:
    if len(angle) < 2:
        return np.full(len(at), angle[0])
    return PchipInterpolator(keys.time, angle)(at)


def _smooth_way(room: Room, keys: _Keys) -> Float[np.ndarray, "points 3"]:
    """The way at even times, as smooth as stays clear: its corners are known to be.

    Straight between the corners first, then averaged over less and less time until no point of it
    comes near anything.
    """
    length = np.linalg.norm(np.diff(keys.eye, axis=0), axis=1).sum()
    count = max(int(length * _PER_METRE), 2 * len(keys.eye_time), 2)
    at = np.linspace(0, max(keys.time[-1], 1e-9), count)
    time = keys.eye_time + 1e-9 * np.arange(len(keys.eye_time))
    way = np.stack([np.interp(at, time, keys.eye[:, k]) for k in range(3)], 1)
    per_frame = count / max(keys.time[-1], 1.0)
    for width in (3.0, 1.5, 0.7):
        smooth = gaussian_filter1d(way, width * per_frame, axis=0, mode="nearest")
        clear = clearance_m(room, smooth) > CLEAR_M + 2 * _TREMOR_M
        if np.all(clear & inside_room(room, smooth, _INSIDE_M + 2 * _TREMOR_M)):
            return smooth
    return way


def _tremor(rng: np.random.Generator, frames: int, amplitude: float) -> np.ndarray:
    """[frames, 3]: three slow waves an axis."""
    t = np.arange(frames)[:, None, None]
    period = rng.uniform(6, 25, (3, 3))
    phase = rng.uniform(0, 2 * np.pi, (3, 3))
    return amplitude * np.sin(2 * np.pi * t / period + phase).mean(2)
