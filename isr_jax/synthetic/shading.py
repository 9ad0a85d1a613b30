"""Colour images: albedo, a procedural texture, and two lights."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, UInt8

from .room import Room

_AMBIENT = 0.34
_LIGHTS = (((0.2, 0.1, 2.35), 0.52), ((-0.9, -0.8, 2.0), 0.28))
"""(place in units of the room's half width and depth, and in metres up; strength)."""
_PLANK_M = (0.14, 1.1)
_SKY = 0.75
_MORTAR_SHARE = 0.035


def shade(
    room: Room,
    points: Float[np.ndarray, "pixels 3"],
    normals: Float[np.ndarray, "pixels 3"],
    albedo: Float[np.ndarray, "pixels 3"],
    instance: np.ndarray,
) -> UInt8[np.ndarray, "pixels 3"]:
    """RGB of surface points: Lambert, I = albedo texture (ambient + sum_i k_i max(0, n . l_i)).

    Args:
        room: Its layout tells which instances are floor and walls.
        points: World frame, metres.
        normals: Unit, towards the camera.
        albedo: In [0, 1].
        instance: 0 where the ray met nothing.
    """
    T = np.asarray(room.T_world_room)
    local = (points - T[:3, 3]) @ T[:3, :3]
    local_normals = normals @ T[:3, :3]
    light = np.full(len(points), _AMBIENT, np.float32)
    for place, strength in _LIGHTS:
        at = np.float32([place[0] * room.size[0] / 2, place[1] * room.size[1] / 2, place[2]])
        towards = at - local
        distance = np.sqrt(np.einsum("pi,pi->p", towards, towards))
        cosine = np.einsum("pi,pi->p", local_normals, towards) / distance
        light += np.float32(strength) * np.maximum(cosine, 0) * _falloff(distance)
    shaded = albedo * (light * texture(room, local, instance))[:, None]
    shaded[instance == 0] = _SKY
    return (np.sqrt(np.clip(shaded, 0, 1)) * 255).astype(np.uint8)


def _falloff(distance: np.ndarray) -> np.ndarray:
    return np.float32(1.6) / (1 + np.float32(0.12) * distance * distance)


def texture(
    room: Room, local: Float[np.ndarray, "pixels 3"], instance: np.ndarray
) -> Float[np.ndarray, " pixels"]:
    """Factor on the albedo: planks on floors, blotches on walls, grain on things."""
    kinds = np.zeros(2 + len(room.layout) + len(room.items), np.int8)
    for patch in room.layout:
        kinds[patch.id] = 1 if patch.class_name == "floor" else 2
    kind = kinds[instance]
    out = np.empty(len(local), np.float32)
    for value, pattern in enumerate((_grain, _planks, _blotches)):
        rows = np.flatnonzero(kind == value)
        out[rows] = pattern(local[rows], instance[rows])
    return out


def _grain(p: np.ndarray, instance: np.ndarray) -> np.ndarray:
    seed = instance.astype(np.float32)
    wave = 61 * p[:, 0] + 17 * p[:, 1] + 29 * p[:, 2] + seed
    return 1 + np.float32(0.035) * np.sin(wave + 2 * np.sin(9 * p[:, 1] + 13 * p[:, 2] + seed))


def _planks(p: np.ndarray, instance: np.ndarray) -> np.ndarray:
    row = np.floor(p[:, 0] / _PLANK_M[0])
    along = p[:, 1] / _PLANK_M[1] + _hash(row, 0 * row)
    brightness = np.float32(0.82) + np.float32(0.3) * _hash(row, np.floor(along))
    across = p[:, 0] / _PLANK_M[0] - row
    joint = (across < _MORTAR_SHARE) | (along - np.floor(along) < _MORTAR_SHARE / 6)
    return np.where(joint, np.float32(0.55), brightness)


def _blotches(p: np.ndarray, instance: np.ndarray) -> np.ndarray:
    slow = np.sin(2.1 * p[:, 0] + 1.3 * p[:, 2]) * np.sin(1.7 * p[:, 1] - 0.9 * p[:, 2])
    fine = _hash(np.floor(p[:, 0] * 90 + p[:, 1] * 70), np.floor(p[:, 2] * 80))
    return 1 + np.float32(0.04) * slow + np.float32(0.05) * (fine - np.float32(0.5))


def _hash(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """A number in [0, 1) for two whole ones."""
    mixed = np.sin(a * np.float32(12.9898) + b * np.float32(78.233)) * np.float32(437.585)
    return (mixed - np.floor(mixed)).astype(np.float32)
