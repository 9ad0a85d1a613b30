"""Surface extraction by naive surface nets over the blocks of the map.

A cell is the cube between 8 neighbouring voxel centres. A cell whose corners are all observed and
of both signs holds one vertex, the mean of its edges' zero crossings; an edge with a sign change
joins the vertices of its four cells in a quadrilateral. No table of cases, shared vertices, and no
face where a cell is missing: unobserved borders stay open (Gibson, "Constrained elastic surface
nets", 1998).
"""

from __future__ import annotations

import functools

import jax
import jax.numpy as jnp
import numpy as np
from jax import lax
from jaxtyping import Float, Int, Shaped, UInt8

from ..config import MappingSettings
from ..types import Array, Mesh, PanopticSurface
from .blocks import BlockIndex
from .pool import BLOCK_SIDE, BLOCK_VOXELS, LABEL_BITS, LABEL_MASK, VoxelPool, unpack_color

_CORNERS = np.array([[i >> 2 & 1, i >> 1 & 1, i & 1] for i in range(8)], np.int32)
"""Corner offsets of a cell, x slowest; also the neighbour blocks that a halo touches."""
_EDGES = np.array([(i, i | b) for i in range(8) for b in (1, 2, 4) if not i & b], np.int32)
_CHUNK = 64


def _with_halo(rows: Shaped[Array, "8 512"]) -> Shaped[Array, "9 9 9"]:
    """A block and the first layers of its 7 upper neighbours."""
    cubes = rows.reshape(2, 2, 2, BLOCK_SIDE, BLOCK_SIDE, BLOCK_SIDE)
    planes = [jnp.concatenate([cubes[0], cubes[1][:, :, :1]], 2)]  # x
    lines = jnp.concatenate([planes[0][0], planes[0][1][:, :, :1]], 2)  # y
    return jnp.concatenate([lines[0], lines[1][:, :, :1]], 2)


def _cell_cases(sdf: Float[Array, "9 9 9"], seen, max_jump_m) -> UInt8[Array, " 512"]:
    """Which corners of each cell are inside, a bit a corner; 0 where no vertex may stand."""
    n = BLOCK_SIDE
    views = [np.s_[x : x + n, y : y + n, z : z + n] for x, y, z in _CORNERS]
    inside = [sdf[v] < 0 for v in views]
    complete = functools.reduce(jnp.logical_and, [seen[v] for v in views])
    case = functools.reduce(
        jnp.bitwise_or, [i.astype(jnp.uint8) << k for k, i in enumerate(inside)]
    )
    span = functools.reduce(jnp.maximum, [sdf[v] for v in views]) - functools.reduce(
        jnp.minimum, [sdf[v] for v in views]
    )
    mixed = complete & (case != 255) & (span < max_jump_m)
    return jnp.where(mixed, case, jnp.uint8(0)).reshape(-1)


@jax.jit
def find_cells(
    sdf_m: Float[Array, "capacity 512"],
    weight: Float[Array, "capacity 512"],
    neighbours: Int[Array, "blocks 8"],
    min_weight: Float[Array, ""],
    max_jump_m: Float[Array, ""],
) -> UInt8[Array, "blocks 512"]:
    """Cases of all cells of the blocks; ``neighbours`` holds rows, out of range where none is."""

    def block(rows):
        sdf = jnp.take(sdf_m, rows, axis=0, mode="fill", fill_value=0.0)
        seen = jnp.take(weight, rows, axis=0, mode="fill", fill_value=-1.0) >= min_weight
        return _cell_cases(_with_halo(sdf), _with_halo(seen), max_jump_m)

    return lax.map(block, neighbours, batch_size=_CHUNK)


def _cell_vertex(sdf: Float[Array, "8"]) -> tuple[Float[Array, "3"], Float[Array, "3"]]:
    """Mean of the zero crossings, in cell units, and the gradient (outward) there."""
    a, b = sdf[_EDGES[:, 0]], sdf[_EDGES[:, 1]]
    crosses = (a < 0) != (b < 0)
    gap = a - b
    t = jnp.where(crosses, a / jnp.where(crosses, gap, 1.0), 0.0)
    start = jnp.asarray(_CORNERS[_EDGES[:, 0]], jnp.float32)
    along = jnp.asarray(_CORNERS[_EDGES[:, 1]], jnp.float32) - start
    points = jnp.where(crosses[:, None], start + t[:, None] * along, 0.0)
    place = jnp.sum(points, 0) / jnp.maximum(jnp.sum(crosses), 1)
    cube = sdf.reshape(2, 2, 2)
    x, y, z = place
    wx, wy, wz = (jnp.stack([1 - c, c]) for c in (x, y, z))
    slope = jnp.array([-1.0, 1.0])
    gradient = jnp.stack(
        [
            jnp.einsum("ijk,i,j,k", cube, slope, wy, wz),
            jnp.einsum("ijk,i,j,k", cube, wx, slope, wz),
            jnp.einsum("ijk,i,j,k", cube, wx, wy, slope),
        ]
    )
    return place, gradient / jnp.maximum(jnp.linalg.norm(gradient), 1e-12)


@jax.jit
def cell_vertices(
    pool: VoxelPool, corner_rows: Int[Array, "cells 8"], corner_voxels: Int[Array, "cells 8"]
):
    """Vertex (cell units), normal, colour and leading map label of each cell."""
    sdf = pool.sdf_m[corner_rows, corner_voxels]
    place, normal = jax.vmap(_cell_vertex)(sdf)
    color = unpack_color(pool.color[corner_rows, corner_voxels])
    painted = jnp.any(color > 0, -1)[..., None]
    mean = jnp.sum(jnp.where(painted, color, 0.0), 1) / jnp.maximum(jnp.sum(painted, 1), 1)
    leader = pool.labels[0][corner_rows, corner_voxels]
    nearest = jnp.sum(jnp.round(place).astype(jnp.int32) * np.array([4, 2, 1]), -1)
    own = jnp.take_along_axis(leader, nearest[:, None], 1)[:, 0]
    surest = jnp.argmax(leader >> LABEL_BITS, 1)
    other = jnp.take_along_axis(leader, surest[:, None], 1)[:, 0]
    label = jnp.where(own > 0, own, other) & LABEL_MASK
    return place, normal, jnp.round(mean).astype(jnp.uint8), label.astype(jnp.int32)


def extract_surface(
    pool: VoxelPool,
    blocks: BlockIndex,
    settings: MappingSettings,
    class_of: Int[np.ndarray, " labels"],
    instance_of: Int[np.ndarray, " labels"],
) -> PanopticSurface:
    """Mesh of the map, and the instance and class that each vertex's label stands for."""
    cells, rows, voxels = _mixed_cells(pool, blocks, settings)
    place, normal, color, label = _vertices(pool, blocks, cells, rows, voxels)
    vertices = ((cells + 0.5 + place) * settings.voxel_size_m).astype(np.float32)
    faces = _faces(blocks, cells, rows, voxels, np.asarray(pool.sdf_m), vertices)
    used = np.zeros(len(vertices), bool)
    used[faces] = True
    faces = (np.cumsum(used) - 1)[faces].astype(np.int32)
    mesh = Mesh(vertices[used], faces, color[used], normal[used])
    instance = instance_of[label[used]].astype(np.int32)
    ids, classes_of = _instance_classes(instance, class_of[label[used]])
    return PanopticSurface(mesh, instance, ids, classes_of, settings.voxel_size_m)


def _instance_classes(instance, class_id):
    """Class of each instance: that of most of its vertices (one class, with triplet counts)."""
    keep = instance > 0
    ids = np.unique(instance[keep])
    table = np.zeros((len(ids), int(class_id.max(initial=0)) + 1), np.int64)
    np.add.at(table, (np.searchsorted(ids, instance[keep]), class_id[keep]), 1)
    return ids.astype(np.int32), table.argmax(1).astype(np.int32)


def _mixed_cells(pool: VoxelPool, blocks: BlockIndex, settings: MappingSettings):
    """Global coordinates, pool row and voxel of every cell that holds a vertex."""
    coords = blocks.coords[: blocks.used]
    neighbours = blocks.rows_at(coords[:, None] + _CORNERS)
    padded = max(_CHUNK, 1 << max(len(coords) - 1, 0).bit_length())
    table = np.full((padded, 8), pool.capacity, np.int32)
    table[: len(coords)] = np.where(neighbours < 0, pool.capacity, neighbours)
    jump_m = np.float32(settings.mesh_max_jump_voxels * settings.voxel_size_m)
    cases = find_cells(pool.sdf_m, pool.weight, table, np.float32(settings.mesh_min_weight), jump_m)
    flat = np.flatnonzero(np.asarray(cases)[: len(coords)])
    rows, voxels = np.divmod(flat, BLOCK_VOXELS)
    local = np.stack(np.unravel_index(voxels, (BLOCK_SIDE,) * 3), -1)
    return coords[rows] * BLOCK_SIDE + local, rows, voxels


def _vertices(pool: VoxelPool, blocks: BlockIndex, cells, rows, voxels):
    size = max(64, 1 << max(len(cells) - 1, 0).bit_length())
    corner_rows = np.zeros((size, 8), np.int32)
    corner_voxels = np.zeros((size, 8), np.int32)
    corners, inner = _address(blocks, cells[:, None] + _CORNERS)
    corner_rows[: len(cells)], corner_voxels[: len(cells)] = corners, inner
    found = cell_vertices(pool, corner_rows, corner_voxels)
    return tuple(np.asarray(f)[: len(cells)] for f in found)


def _address(blocks: BlockIndex, voxel):
    """Pool row (-1 = none) and place in the block of global voxel coordinates."""
    rows = blocks.rows_at(voxel >> 3)
    x, y, z = np.moveaxis(voxel & 7, -1, 0)
    return rows, (x * BLOCK_SIDE + y) * BLOCK_SIDE + z


def _faces(blocks: BlockIndex, cells, rows, voxels, sdf_m, vertices) -> Int[np.ndarray, "faces 3"]:
    """Two triangles for each crossed edge whose four cells all hold a vertex, normals outward."""
    vertex_of = np.full((blocks.used + 1, BLOCK_VOXELS), -1, np.int32)
    vertex_of[rows, voxels] = np.arange(len(cells), dtype=np.int32)
    inside = sdf_m[rows, voxels] < 0
    quads = []
    for axis in range(3):
        b, c = np.eye(3, dtype=np.int32)[[(axis + 1) % 3, (axis + 2) % 3]]
        end = _address(blocks, cells + np.eye(3, dtype=np.int32)[axis])
        crossed = np.flatnonzero(inside != (sdf_m[end] < 0))
        around = [cells[crossed] - step for step in (0 * b, b, b + c, c)]
        quad = np.stack([vertex_of[_address(blocks, cell)] for cell in around], 1)
        quad[~inside[crossed]] = quad[~inside[crossed]][:, ::-1]
        quads.append(quad[np.all(quad >= 0, 1)])
    return _triangles(np.concatenate(quads), vertices)


def _triangles(quads, vertices) -> Int[np.ndarray, "faces 3"]:
    """Each quadrilateral cut along its shorter diagonal."""
    p = vertices[quads]
    first = np.linalg.norm(p[:, 0] - p[:, 2], axis=1) <= np.linalg.norm(p[:, 1] - p[:, 3], axis=1)
    turned = np.where(first[:, None], quads, np.roll(quads, -1, 1))
    return np.concatenate([turned[:, [0, 1, 2]], turned[:, [0, 2, 3]]])
