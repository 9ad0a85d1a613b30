"""The way of a hand-held camera through a room."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float
from scipy.interpolate import PchipInterpolator

from .room import PlacedModel, Room

EYE_HEIGHT_M = 1.45
_WALL_DISTANCE_M = 1.25
_KEYS_ACROSS = 12
_ASIDE = (0.9, -0.9)
"""Each round of visits looks at things from so far aside, radians around the room's middle."""
_SLOWEST = 0.25
"""Least angle that counts between two keys, so that none is passed in no time."""
_TREMOR_M, _TREMOR_RAD = 0.004, 0.006


def camera_path(room: Room, frames: int, seed: int) -> Float[np.ndarray, "frames 4 4"]:
    """``T_world_camera`` of each frame, float64.

    One lap that looks across the room, over what stands in its middle, then two that look at
    each piece of furniture along the walls in turn, from either side: a smooth way through
    jittered keys at even angular speed, with the slow tremor of a hand on top.
    """
    rng = np.random.default_rng([seed, 1])
    keys = _keys(room, rng)
    step = np.abs(np.diff(keys, axis=0))
    turning = np.maximum(np.hypot(step[:, 3], step[:, 4]), step[:, 5])
    times = np.concatenate([[0], np.cumsum(np.maximum(turning, _SLOWEST))])
    way = PchipInterpolator(times / times[-1], keys)(np.linspace(0, 1, frames))
    eye = way[:, :3] + _tremor(rng, frames, _TREMOR_M)
    tremor = _tremor(rng, frames, _TREMOR_RAD)
    heading, pitch = way[:, 3] + tremor[:, 0], way[:, 4] + tremor[:, 1]
    level = np.cos(pitch)
    forward = np.stack([level * np.cos(heading), level * np.sin(heading), np.sin(pitch)], 1)
    T_room_camera = np.stack([look_along(e, f) for e, f in zip(eye, forward, strict=True)])
    return np.asarray(room.T_world_room, np.float64) @ T_room_camera


def _keys(room: Room, rng: np.random.Generator) -> np.ndarray:
    """[keys, 6]: eye x, y, z, heading, pitch, and the eye's angle around the room's middle."""
    start = rng.uniform(0, 2 * np.pi)
    angle = start + 2 * np.pi * np.arange(_KEYS_ACROSS) / _KEYS_ACROSS
    pitch = np.where(np.arange(_KEYS_ACROSS) % 2, -0.5, -0.4)
    across = [_key(room, rng, a, a + np.pi, p) for a, p in zip(angle, pitch, strict=True)]
    visits = [
        _visit(room, rng, target, aside)
        for aside in _ASIDE
        for target in _furniture(room, float(angle[-1]))
    ]
    keys = np.array([*across, *visits])
    keys[:, [3, 5]] = np.unwrap(keys[:, [3, 5]], axis=0)
    return keys


def _key(
    room: Room, rng: np.random.Generator, angle: float, heading: float, pitch: float
) -> list[float]:
    """An eye on the ring around the room's middle, and where it looks; jittered."""
    ring = np.maximum(np.asarray(room.size[:2], np.float64) / 2 - _WALL_DISTANCE_M, 0.3)
    x, y = ring * [np.cos(angle), np.sin(angle)] * rng.uniform(0.85, 1.1)
    z = EYE_HEIGHT_M + rng.uniform(-0.12, 0.15)
    aim = rng.uniform(-0.06, 0.06, 2)
    return [float(x), float(y), z, heading + aim[0], pitch + aim[1], angle]


def _visit(room: Room, rng: np.random.Generator, target: np.ndarray, aside: float) -> list[float]:
    """A key that looks at a point from aside."""
    angle = float(np.arctan2(target[1], target[0])) + aside
    x, y, z, *_ = _key(room, rng, angle, 0.0, 0.0)
    dx, dy, dz = target - [x, y, z]
    heading, pitch = np.arctan2(dy, dx), np.arctan2(dz, np.hypot(dx, dy))
    return [x, y, z, float(heading), float(max(pitch, -0.7)), angle]


def _furniture(room: Room, start: float) -> list[np.ndarray]:
    """What to look at of each thing along or on the walls, room frame, counter-clockwise."""
    T = np.asarray(room.T_world_room, np.float64)
    targets = []
    for item in room.items:
        x, y, z = T[:3, :3].T @ (item.center - T[:3, 3])
        if item.attachment == "wall":
            targets.append(np.array([x, y, z]))
        elif item.parent == room.layout[0].name and _at_wall(room, item):
            targets.append(np.array([x, y, np.clip(1.6 * z, 0.4, 1.0)]))
    return sorted(targets, key=lambda t: (np.arctan2(t[1], t[0]) - start) % (2 * np.pi))


def _at_wall(room: Room, item: PlacedModel) -> bool:
    gaps = [float((item.center - p.corners[0]) @ p.normal) for p in room.layout[1:5]]
    return min(gaps) < float(max(item.box.size[:2])) / 2 + 0.3


def _tremor(rng: np.random.Generator, frames: int, amplitude: float) -> np.ndarray:
    """[frames, 3]: three slow waves an axis."""
    t = np.arange(frames)[:, None, None]
    period = rng.uniform(6, 25, (3, 3))
    phase = rng.uniform(0, 2 * np.pi, (3, 3))
    return amplitude * np.sin(2 * np.pi * t / period + phase).mean(2)


def look_along(eye: np.ndarray, forward: np.ndarray) -> Float[np.ndarray, "4 4"]:
    """Pose of an upright camera (x right, y down, z forward) that does not look straight down."""
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    T = np.eye(4)
    T[:3, :3] = np.stack([right, np.cross(forward, right), forward], 1)
    T[:3, 3] = eye
    return T
