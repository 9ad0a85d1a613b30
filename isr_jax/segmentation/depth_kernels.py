"""Kernels of depth segmentation (Furrer et al. 2018): normals, discontinuity and convexity maps.

Written for one depth image. Windows are read as shifted slices of a padded image, which XLA turns
into one vectorised loop. Vectors are three images, not one image of vectors: a last axis of three
does not vectorise. XLA compiles a loop for each output, so what several need stands before a
barrier.
"""

from __future__ import annotations

from itertools import product

import jax.numpy as jnp
from jax import lax
from jaxtyping import Bool, Float, Int

from ..types import Array, Camera

_MIN_NORMAL_SUPPORT = 12.0
"""Pixels that a normal's plane is fitted to, at least."""
_COLUMN_BITS = 16
_COLUMN_MASK = (1 << _COLUMN_BITS) - 1
"""A pixel is ``row << _COLUMN_BITS | column``."""
_NO_SEED = -1


def _ray_slopes(camera: Camera) -> tuple[Array, Array]:
    """x and y of the viewing rays with z = 1, a row and a column: times depth, a pixel's point."""
    u = (jnp.arange(camera.width, dtype=jnp.float32) - camera.cx) * (1.0 / camera.fx)
    v = (jnp.arange(camera.height, dtype=jnp.float32) - camera.cy) * (1.0 / camera.fy)
    return u[None, :], v[:, None]


def _shifted(padded: Array, dy: int, dx: int, radius: tuple[int, int], shape: tuple) -> Array:
    """The image moved so that pixel (i, j) holds its neighbour (i + dy, j + dx)."""
    start = (radius[0] + dy, radius[1] + dx)
    return lax.slice(padded, start, (start[0] + shape[0], start[1] + shape[1]))


def _offsets(window: int) -> list[tuple[int, int]]:
    reach = range(-(window // 2), window // 2 + 1)
    return [(dy, dx) for dy, dx in product(reach, reach) if (dy, dx) != (0, 0)]


def _row_sums(inverse_depth: Array, window: int, depth_ratio: Array) -> list:
    """Sums over a pixel's row window: 1, dx, dx^2, dw, dw dx, of neighbours near its depth."""
    radius = window // 2
    padded = jnp.pad(inverse_depth, ((0, 0), (radius, radius)))
    sums = [jnp.zeros_like(inverse_depth)] * 5
    for dx in range(-radius, radius + 1):
        neighbour = _shifted(padded, 0, dx, (0, radius), inverse_depth.shape)
        dw = neighbour - inverse_depth
        near = jnp.where(jnp.abs(dw) < depth_ratio * neighbour, 1.0, 0.0)
        terms = (near, near * dx, near * (dx * dx), near * dw, near * dw * dx)
        sums = [s + t for s, t in zip(sums, terms, strict=True)]
    return sums


def _window_sums(inverse_depth: Array, window: int, depth_ratio: Array) -> list:
    """Sums over the square window: 1, dx, dy, dx^2, dx dy, dy^2, dw, dw dx, dw dy."""
    radius = window // 2
    columns = ((radius, radius), (0, 0))
    rows = [jnp.pad(s, columns) for s in _row_sums(inverse_depth, window, depth_ratio)]
    padded = jnp.pad(inverse_depth, columns)
    # Without the barrier XLA recomputes the row sums for each of the column shifts.
    rows, padded = lax.optimization_barrier((rows, padded))
    sums = [jnp.zeros_like(inverse_depth)] * 9
    for dy in range(-radius, radius + 1):
        at = (dy, 0, (radius, 0), inverse_depth.shape)
        neighbour = _shifted(padded, *at)
        step = neighbour - inverse_depth
        near = jnp.where(jnp.abs(step) < depth_ratio * neighbour, 1.0, 0.0)
        n, x, xx, w, wx = (near * _shifted(row, *at) for row in rows)
        w, wx = w + step * n, wx + step * x
        terms = (n, x, n * dy, xx, x * dy, n * (dy * dy), w, wx, w * dy)
        sums = [s + t for s, t in zip(sums, terms, strict=True)]
    return sums


def normals(
    depth_m: Float[Array, "height width"],
    camera: Camera,
    window: int,
    depth_ratio: Float[Array, ""],
) -> tuple[Float[Array, "3 height width"], Bool[Array, "height width"]]:
    """Unit normals towards the camera (camera frame), and where there is one; 0 elsewhere.

    A plane n . v = 1 is linear in inverse depth, w = n . ray(u, v), so its least-squares fit
    w ~ a du + b dv + c over the window needs nine sums and no eigenvectors. Its residual is in
    inverse depth, in which the noise of a structured-light camera is even.

    Departure from Furrer et al.: they take the smallest eigenvector of the covariance of the
    window's points. A neighbour counts if it is within ``depth_ratio`` of the pixel of this
    column in its row, and that one of the centre (theirs: of the centre), which makes the
    window separable: 26 terms a pixel instead of 169.
    """
    inverse_depth = jnp.where(depth_m > 0, 1.0 / jnp.where(depth_m > 0, depth_m, 1.0), 0.0)
    inverse_depth = lax.optimization_barrier(inverse_depth)
    sums = lax.optimization_barrier(tuple(_window_sums(inverse_depth, window, depth_ratio)))
    n, x, y, xx, xy, yy, w, wx, wy = sums
    count = jnp.maximum(n, 1.0)
    xx, xy, yy = xx - x * x / count, xy - x * y / count, yy - y * y / count
    wx, wy = wx - w * x / count, wy - w * y / count
    determinant = xx * yy - xy * xy
    valid = (n >= _MIN_NORMAL_SUPPORT) & (determinant > 1.0)
    safe = jnp.where(valid, determinant, 1.0)
    a, b = (yy * wx - xy * wy) / safe, (xx * wy - xy * wx) / safe
    c = inverse_depth + (w - a * x - b * y) / count
    ray_x, ray_y = _ray_slopes(camera)
    nx, ny = a * camera.fx, b * camera.fy
    nz = c - nx * ray_x - ny * ray_y
    length = jnp.sqrt(jnp.where(valid, nx * nx + ny * ny + nz * nz, 1.0))
    unit = jnp.where(valid, -1.0 / length, 0.0)
    return jnp.stack([nx * unit, ny * unit, nz * unit]), valid


def discontinuity_map(
    depth_m: Float[Array, "height width"],
    normal: Float[Array, "3 height width"],
    camera: Camera,
    window: int,
    ratio: Float[Array, ""],
) -> Bool[Array, "height width"]:
    """True where depth steps to a neighbour by more than ratio z, and leaves the tangent plane so.

    Departures from Furrer et al., who look at |z' - z| alone: a floor seen at a grazing angle
    steps from pixel to pixel and is one surface, so the step from where the tangent plane meets
    the neighbour's ray counts too; and neighbours without return say nothing (theirs are steps,
    which shatters surfaces with dropouts).
    """
    radius = window // 2
    padded = jnp.pad(depth_m, radius)
    ray_x, ray_y = _ray_slopes(camera)
    facing = normal[0] * ray_x + normal[1] * ray_y + normal[2]
    slope_x, slope_y = normal[0] * (1.0 / camera.fx), normal[1] * (1.0 / camera.fy)
    limit, steps = ratio * depth_m, jnp.zeros_like(depth_m, bool)
    for dy, dx in _offsets(window):
        z = _shifted(padded, dy, dx, (radius, radius), depth_m.shape)
        # n . ray' z_plane = n . ray z, times n . ray' < 0 to spare the division
        facing_there = facing + dx * slope_x + dy * slope_y
        leaves = jnp.abs(facing_there * z - facing * depth_m) > limit * jnp.abs(facing_there)
        leaves |= facing_there >= 0
        steps |= (z > 0) & (jnp.abs(z - depth_m) > limit) & leaves
    return steps & (depth_m > 0)


def convexity_map(
    depth_m: Float[Array, "height width"],
    normal: Float[Array, "3 height width"],
    camera: Camera,
    window: int,
    mask_m: Float[Array, ""],
) -> Float[Array, "height width"]:
    """Phi = min over the window of (1 where convex, else n . n'), after Tateno et al. 2015.

    Two points v, v' are concave where (v - v') . (n - n') / 2 < mask_m, normals towards the
    camera: each stands out of the other's tangent plane. Neighbours without depth or normal count
    as convex.

    Departure: they ask for (v - v') . n alone. The window of a normal rounds edges off, its
    tangent plane leans there, and so half of every convex edge looked concave.
    """
    radius = window // 2
    ray_x, ray_y = _ray_slopes(camera)
    depth_near = jnp.pad(depth_m, radius)
    normal_near = [jnp.pad(normal[k], radius) for k in range(3)]
    depth_near, *normal_near = lax.optimization_barrier((depth_near, *normal_near))
    phi = jnp.ones_like(depth_m)
    for dy, dx in _offsets(window):
        at = (dy, dx, (radius, radius), depth_m.shape)
        z = _shifted(depth_near, *at)
        other = [_shifted(n, *at) for n in normal_near]
        cosine = sum(normal[k] * other[k] for k in range(3))
        # v' - v = ray (z' - z) + z' (dx / fx, dy / fy, 0)
        move = [
            ray_x * (z - depth_m) + z * (dx / camera.fx),
            ray_y * (z - depth_m) + z * (dy / camera.fy),
            z - depth_m,
        ]
        turn = sum(move[k] * (other[k] - normal[k]) for k in range(3))
        concave_at = 0.5 * turn < mask_m
        has_normal = _shifted(normal_near[2], *at) != 0
        concave = concave_at & (z > 0) & has_normal
        phi = jnp.minimum(phi, jnp.where(concave, cosine, 1.0))
    return phi


def _grow(mask: Array) -> Array:
    """Dilation by 3 x 3."""
    for axis in (0, 1):
        pads = [(1, 1) if a == axis else (0, 0) for a in (0, 1)]
        padded = jnp.pad(mask, pads)
        for step in (-1, 1):
            move = (step, 0, (1, 0)) if axis == 0 else (0, step, (0, 1))
            mask = mask | _shifted(padded, *move, mask.shape)
    return mask


def opened_closed(mask: Bool[Array, "height width"]) -> Bool[Array, "height width"]:
    """Morphological opening, then closing, by 3 x 3; what lies outside the image is kept."""
    opened = _grow(~_grow(~mask))
    return ~_grow(~_grow(opened))


def interior_map(
    depth_m: Float[Array, "height width"],
    camera: Camera,
    normal_window: int,
    discontinuity_window: int,
    convexity_window: int,
    limits: Float[Array, " 4"],
) -> Bool[Array, "height width"]:
    """True where a pixel is inside a depth segment, False on edges and without return.

    Args:
        limits: normal depth ratio, discontinuity ratio, convexity mask (m), convexity threshold.
    """
    normal, has_normal = normals(depth_m, camera, normal_window, limits[0])
    # Without the barriers XLA recomputes windows inside windows: three times slower.
    normal, has_normal = lax.optimization_barrier((normal, has_normal))
    phi = convexity_map(depth_m, normal, camera, convexity_window, limits[2])
    convex = lax.optimization_barrier((phi >= limits[3]) & has_normal)
    smooth = lax.optimization_barrier(opened_closed(convex))
    steps = discontinuity_map(depth_m, normal, camera, discontinuity_window, limits[1])
    return smooth & has_normal & ~steps & (depth_m > 0)


def join_edges(
    label: Int[Array, "height width"],
    depth_m: Float[Array, "height width"],
    camera: Camera,
    window: int,
    distance_m: Float[Array, ""],
) -> Int[Array, "height width"]:
    """Give each unlabelled pixel with depth the label of the nearest labelled point about it.

    The label spreads by one pixel per round, window / 2 rounds, always carrying the point it began
    at, so that a pixel joins within the window and ``distance_m`` of it. Unlike a search of the
    whole window it never jumps a gap, and needs 8 neighbours per round instead of 80 at once.
    """
    ray_x, ray_y = _ray_slopes(camera)
    step_x, step_y = 1.0 / camera.fx, 1.0 / camera.fy
    rows, columns = (jnp.arange(n, dtype=jnp.int32) for n in depth_m.shape)
    # A point is two words instead of three: the pixel that it was seen in, and its depth.
    here = rows[:, None] << _COLUMN_BITS | columns[None, :]
    seed, seed_depth = jnp.where(label > 0, here, _NO_SEED), depth_m
    for _ in range(window // 2):
        padded = (jnp.pad(seed, 1, constant_values=_NO_SEED), jnp.pad(seed_depth, 1))
        padded = lax.optimization_barrier(padded)
        best = jnp.where((seed < 0) & (depth_m > 0), distance_m * distance_m, 0.0)
        for dy, dx in _offsets(3):
            other, z = (_shifted(p, dy, dx, (1, 1), depth_m.shape) for p in padded)
            x = ((other & _COLUMN_MASK).astype(jnp.float32) - camera.cx) * step_x
            y = ((other >> _COLUMN_BITS).astype(jnp.float32) - camera.cy) * step_y
            gap = (ray_x * depth_m - x * z) ** 2 + (ray_y * depth_m - y * z) ** 2
            gap = gap + (depth_m - z) ** 2
            better = (other >= 0) & (gap < best)
            best = jnp.where(better, gap, best)
            seed, seed_depth = jnp.where(better, other, seed), jnp.where(better, z, seed_depth)
        seed, seed_depth = lax.optimization_barrier((seed, seed_depth))
    found = jnp.maximum(seed, 0)
    flat = (found >> _COLUMN_BITS) * depth_m.shape[1] + (found & _COLUMN_MASK)
    flat = lax.optimization_barrier(flat)
    return jnp.where(seed >= 0, jnp.ravel(label)[flat], 0)
