"""Colour of what a ray meets: a texture under a lamp that throws shadows, and under a dimmer one.

Everything is float32 in one compiled kernel; procedural textures are looked up in tiles made once,
which takes a tenth of the time that their sines and hashes would take per pixel.
"""

from __future__ import annotations

from collections.abc import Sequence

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
from jaxtyping import Float, Int, UInt8

from ...types import Array
from ..room import Room
from ..surface import Surface
from .patterns import TILE_M, pattern_of, tiles
from .textures import Atlas, atlas

_AMBIENT = 0.34
_GROUND = 0.12
"""Less of the ambient light comes from below by this share."""
_LAMP, _FILL = 0.52, 0.28
"""Strengths of the lamp, which throws shadows, and of the other light."""
_LAMP_PLACES = ((0.2, 0.1), (-0.2, 0.15), (0.0, -0.25), (0.35, -0.1), (-0.4, -0.1), (0.1, 0.4))
"""In units of the room's half width and depth."""
_FILL_PLACE = (-0.9, -0.8)
_BELOW_CEILING_M = (0.15, 0.5)
_LAMP_CLEAR_M = 0.4
_VOID = (0.66, 0.74, 0.82)
"""What a ray sees that leaves through an opening."""
_UNTEXTURED = np.zeros((1, 3))


class Studio(eqx.Module):
    """What shading needs of a room. Tables of faces have a last row for rays that meet none."""

    T_room_world: Float[Array, "4 4"]
    lights: Float[Array, "2 3"]
    """The lamp and the dimmer light, world frame, metres."""
    normal: Float[Array, "faces 3"]
    """Unit, world frame."""
    gain: Float[Array, "faces 3"]
    uv: Float[Array, "faces 6"]
    """Texture coordinates of the corners."""
    image: Int[Array, "faces 3"]
    """First texel, height, width."""
    pattern: Int[Array, " faces"]
    """Row of ``tiles``."""
    texels: UInt8[Array, "texels 3"]
    tiles: Float[Array, "patterns side side"]
    tile_m: Float[Array, " patterns"]


class Developed(eqx.Module):
    """What a camera makes of the hits of its rays."""

    rgb: UInt8[Array, "*rays 3"]
    normal: Float[Array, "*rays 3"]
    """Unit, towards the camera, world frame."""
    incidence: Float[Array, "*rays"]
    """Angle between ray and normal, radians."""
    albedo: Float[Array, "*rays"]
    """Mean over the colours, in [0, 1]: what an infrared pattern would be dimmed by."""


def studio(
    room: Room,
    class_names: Sequence[str],
    surfaces: Sequence[Surface],
    normal: Float[np.ndarray, "faces 3"],
) -> Studio:
    """Lights under the ceiling and the textures of all faces.

    Args:
        room: Gives the frame of the patterns, and room for the lamp.
        class_names: Of each surface.
        surfaces: In the order in which their faces are counted.
        normal: Of those faces, world frame.

    Raises:
        LibraryError: a texture is no image that can be read.
    """
    wears: Atlas = atlas(surfaces)
    pattern = [
        np.where(_worn(surface), 0, pattern_of(name))
        for name, surface in zip(class_names, surfaces, strict=True)
    ]
    # A ray that meets nothing reads the last row, as triangle -1.
    return Studio(
        T_room_world=np.linalg.inv(room.T_world_room).astype(np.float32),
        lights=np.stack([lamp_place(room), _at(room, _FILL_PLACE, _BELOW_CEILING_M[1])]),
        normal=np.append(normal, _UNTEXTURED, 0).astype(np.float32),
        gain=np.append(wears.face_gain, _UNTEXTURED, 0).astype(np.float32),
        uv=np.append(wears.face_uv.reshape(-1, 6), np.zeros((1, 6)), 0).astype(np.float32),
        image=np.append(wears.face_image, [[0, 1, 1]], 0).astype(np.int32),
        pattern=np.append(np.concatenate(pattern), 0).astype(np.int32),
        texels=wears.texels,
        tiles=tiles(),
        tile_m=np.array(TILE_M, np.float32),
    )


def _worn(surface: Surface) -> np.ndarray:
    if surface.face_texture is None:
        return np.zeros(len(surface.face_rgb), bool)
    return surface.face_texture >= 0


def lamp_place(room: Room) -> Float[np.ndarray, "3"]:
    """Under the ceiling, world frame: the first place that is clear of things, else the clearest.

    A lamp inside a cabinet would leave the room in its shadow.
    """
    places = np.array([_at(room, place, _BELOW_CEILING_M[0]) for place in _LAMP_PLACES])
    gap = np.full(len(places), np.inf)
    for item in room.items:
        local = (places - item.center) @ item.T_world_cad[:3, :3]
        outside = np.abs(local) - item.scale * np.asarray(item.model.size) / 2
        gap = np.minimum(gap, np.linalg.norm(np.maximum(outside, 0), axis=1))
    clear = np.flatnonzero(gap > _LAMP_CLEAR_M)
    return places[clear[0] if len(clear) else int(np.argmax(gap))]


def _at(room: Room, place: tuple[float, float], below_m: float) -> np.ndarray:
    x, y = np.asarray(room.size[:2]) / 2 * place
    T = np.asarray(room.T_world_room)
    return (T[:3, :3] @ [x, y, room.size[2] - below_m] + T[:3, 3]).astype(np.float32)


def develop_ray(
    scene: Studio,
    eye: Float[Array, "3"],
    direction: Float[Array, "3"],
    distance: Float[Array, ""],
    triangle: Int[Array, ""],
    barycentric: Float[Array, "2"],
    lit: Float[Array, ""],
) -> Developed:
    """Facing normal, incidence and colour of one hit.

    I = albedo (ambient + sum_i k_i f(r_i) max(0, n . l_i) v_i), shown as sqrt(I) (gamma 2), with
    albedo = gain texel pattern and v the visibility of the light (1 for the dimmer one).

    Args:
        scene: Lights and textures.
        eye: World frame, metres.
        direction: Of the ray, not unit.
        distance: To the hit, in lengths of the direction.
        triangle: That was hit; -1 for none.
        barycentric: Weights of its second and third corner.
        lit: Share of the lamp that the point sees.
    """
    row = jnp.where(triangle < 0, scene.normal.shape[0] - 1, triangle)
    normal = scene.normal[row]
    facing = _dot(normal, direction)
    normal = jnp.where(facing > 0, -normal, normal)
    cosine = jnp.abs(facing) / jnp.sqrt(_dot(direction, direction))
    point = eye + distance * direction
    albedo = scene.gain[row] * _texel(scene, row, barycentric) * _tile(scene, row, point, normal)
    albedo = jnp.clip(albedo, 0.0, 1.0)
    light = _AMBIENT * (1 - _GROUND * (1 - normal[2]))
    light += _LAMP * lit * _arriving(scene.lights[0], point, normal)
    light += _FILL * _arriving(scene.lights[1], point, normal)
    shown = jnp.where(triangle < 0, jnp.array(_VOID), jnp.clip(albedo * light, 0.0, 1.0))
    return Developed(
        rgb=(jnp.sqrt(shown) * 255).astype(jnp.uint8),
        normal=normal,
        incidence=jnp.arccos(jnp.clip(cosine, 0.0, 1.0)),
        albedo=(albedo[0] + albedo[1] + albedo[2]) / 3,
    )


develop = jax.jit(jax.vmap(develop_ray, (None, None, 0, 0, 0, 0, 0)))
"""`develop_ray` for many rays of one eye."""


def _dot(a: Array, b: Array) -> Array:
    """Written out: over many rays it is one loop, where a sum over an axis of three is not."""
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def _arriving(light: Array, point: Array, normal: Array) -> Array:
    """f(r) max(0, n . l) of one light."""
    towards = light - point
    squared = _dot(towards, towards)
    slant = jnp.maximum(_dot(towards, normal), 0) / jnp.maximum(jnp.sqrt(squared), 1e-3)
    return 1.6 / (1 + 0.12 * squared) * slant


def _texel(scene: Studio, row: Array, barycentric: Array) -> Array:
    """Nearest texel of the face's image, which repeats, in [0, 1]."""
    corners = scene.uv[row]
    second, third = barycentric[0], barycentric[1]
    first = 1 - second - third
    u = first * corners[0] + second * corners[2] + third * corners[4]
    v = first * corners[1] + second * corners[3] + third * corners[5]
    start, height, width = scene.image[row]
    column = jnp.floor((u - jnp.floor(u)) * width).astype(jnp.int32)
    # v counts upwards, rows downwards.
    line = jnp.floor((1 - (v - jnp.floor(v))) * height).astype(jnp.int32)
    line, column = jnp.clip(line, 0, height - 1), jnp.clip(column, 0, width - 1)
    return scene.texels[start + line * width + column].astype(jnp.float32) / 255


def _tile(scene: Studio, row: Array, point: Array, normal: Array) -> Array:
    """The pattern where the point falls on it, seen along the room's axis nearest the normal."""
    kind = scene.pattern[row]
    R, t = scene.T_room_world[:3, :3], scene.T_room_world[:3, 3]
    x, y, z = (_dot(R[i], point) + t[i] for i in range(3))
    nx, ny, nz = (jnp.abs(_dot(R[i], normal)) for i in range(3))
    flat = nz >= jnp.maximum(nx, ny)
    along = jnp.where(flat, x, z) / scene.tile_m[kind]
    across = jnp.where(flat | (nx > ny), y, x) / scene.tile_m[kind]
    side = scene.tiles.shape[1]
    i = jnp.floor((along - jnp.floor(along)) * side).astype(jnp.int32)
    j = jnp.floor((across - jnp.floor(across)) * side).astype(jnp.int32)
    return scene.tiles[kind, jnp.minimum(i, side - 1), jnp.minimum(j, side - 1)]
