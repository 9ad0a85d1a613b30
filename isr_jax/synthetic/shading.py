"""Colour of what a ray meets: albedo, a procedural texture, and two lights."""

from __future__ import annotations

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int, UInt8

from ..types import Array
from .room import Room

_AMBIENT = 0.34
_LIGHTS = (((0.2, 0.1, 2.35), 0.52), ((-0.9, -0.8, 2.0), 0.28))
"""(place in units of the room's half width and depth, and in metres up; strength)."""
_PLANK_M = (0.14, 1.1)
_JOINT_SHARE = 0.035
_VOID = 0.75
"""Brightness where a ray meets nothing."""
_GRAIN, _PLANKS, _BLOTCHES = range(3)


class Studio(eqx.Module):
    """What shading needs of a room."""

    T_room_world: Float[Array, "4 4"]
    lights: Float[Array, "lights 3"]
    """Room frame, metres."""
    strength: Float[Array, " lights"]
    texture: Int[Array, " entities"]
    """Pattern of each entity id; 0 where there is none."""


def studio(room: Room) -> Studio:
    """Lights under the ceiling, planks on the floor, blotches on the walls, grain on things."""
    scale = np.array([room.size[0] / 2, room.size[1] / 2, 1.0])
    texture = np.full(1 + len(room.layout) + len(room.items), _GRAIN, np.int32)
    for patch in room.layout:
        texture[patch.id] = _PLANKS if patch.class_name == "floor" else _BLOTCHES
    return Studio(
        np.linalg.inv(room.T_world_room).astype(np.float32),
        np.array([scale * place for place, _ in _LIGHTS], np.float32),
        np.array([strength for _, strength in _LIGHTS], np.float32),
        texture,
    )


def shade_point(
    scene: Studio,
    point: Float[Array, "3"],
    normal: Float[Array, "3"],
    albedo: Float[Array, "3"],
    instance: Int[Array, ""],
) -> UInt8[Array, "3"]:
    """RGB of a surface point: I = albedo texture (ambient + sum_i k_i f(r_i) max(0, n . l_i)).

    Args:
        scene: Lights and textures.
        point: World frame, metres.
        normal: Unit, towards the camera.
        albedo: In [0, 1].
        instance: 0 where the ray met nothing.
    """
    R = scene.T_room_world[:3, :3]
    local = R @ point + scene.T_room_world[:3, 3]
    towards = scene.lights - local
    distance = jnp.sqrt(jnp.sum(towards * towards, 1))
    cosine = jnp.maximum(towards @ (R @ normal), 0) / jnp.maximum(distance, 1e-3)
    falloff = 1.6 / (1 + 0.12 * distance * distance)
    light = _AMBIENT + jnp.sum(scene.strength * falloff * cosine)
    shaded = albedo * light * _texture(scene.texture[instance], local, instance)
    shaded = jnp.where(instance == 0, _VOID, jnp.clip(shaded, 0.0, 1.0))
    return (jnp.sqrt(shaded) * 255).astype(jnp.uint8)


class Developed(eqx.Module):
    """What a camera makes of the hits of its rays."""

    rgb: UInt8[Array, "*rays 3"]
    point: Float[Array, "*rays 3"]
    """World frame, metres; the eye where the ray met nothing."""
    normal: Float[Array, "*rays 3"]
    """Unit, towards the camera, world frame."""
    incidence: Float[Array, "*rays"]
    """Angle between ray and normal, radians."""


def develop_ray(
    scene: Studio,
    eye: Float[Array, "3"],
    direction: Float[Array, "3"],
    distance: Float[Array, ""],
    normal: Float[Array, "3"],
    albedo: Float[Array, "3"],
    instance: Int[Array, ""],
) -> Developed:
    """Point, facing normal, incidence and colour of one hit; ``distance`` in ray lengths."""
    point = eye + distance * direction
    facing = jnp.dot(normal, direction)
    normal = jnp.where(facing > 0, -normal, normal)
    cosine = jnp.abs(facing) / jnp.sqrt(jnp.sum(direction * direction))
    return Developed(
        rgb=shade_point(scene, point, normal, albedo, instance),
        point=point,
        normal=normal,
        incidence=jnp.arccos(jnp.clip(cosine, 0.0, 1.0)),
    )


develop = jax.jit(jax.vmap(develop_ray, (None, None, 0, 0, 0, 0, 0)))
"""`develop_ray` for many rays of one eye."""


def _texture(kind, p, instance):
    """Factor on the albedo."""
    seed = instance.astype(jnp.float32)
    wave = 61 * p[0] + 17 * p[1] + 29 * p[2] + seed
    grain = 1 + 0.035 * jnp.sin(wave + 2 * jnp.sin(9 * p[1] + 13 * p[2] + seed))
    slow = jnp.sin(2.1 * p[0] + 1.3 * p[2]) * jnp.sin(1.7 * p[1] - 0.9 * p[2])
    fine = _hash(jnp.floor(90 * p[0] + 70 * p[1]), jnp.floor(80 * p[2]))
    blotches = 1 + 0.04 * slow + 0.05 * (fine - 0.5)
    return jnp.where(kind == _PLANKS, _planks(p), jnp.where(kind == _BLOTCHES, blotches, grain))


def _planks(p):
    across, row = jnp.modf(p[0] / _PLANK_M[0] + 100.0)
    along, board = jnp.modf(p[1] / _PLANK_M[1] + 100.0 + _hash(row, 0.0))
    joint = (across < _JOINT_SHARE) | (along < _JOINT_SHARE / 6)
    return jnp.where(joint, 0.55, 0.82 + 0.3 * _hash(row, board))


def _hash(a, b):
    """A number in [0, 1) for two whole ones."""
    mixed = jnp.sin(a * 12.9898 + b * 78.233) * 437.585
    return mixed - jnp.floor(mixed)
