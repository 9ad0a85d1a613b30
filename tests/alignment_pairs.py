"""Pairs of entities and models with known answers, for tests of the alignment."""

from __future__ import annotations

import dataclasses

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from isr_jax.alignment import (
    AlignmentProblem,
    AlignmentSolution,
    AlignmentWeights,
    SurfacePairs,
    align,
)
from isr_jax.config import DEFAULT_SUPPORT, AlignmentSettings
from isr_jax.geometry import CUBE_ROTATIONS
from isr_jax.types import ROOM, Box, Shortlist

from .builders import (
    box_entity,
    box_planes,
    floor_entity,
    library_of,
    parts_model,
    rotation_z,
    scene_of,
    support_graph,
    table_model,
)

SETTINGS = AlignmentSettings()
WEIGHTS = AlignmentWeights.of(SETTINGS)
LANES = 8
"""Of one shape, so that it compiles once."""


def pairs_of(seed: int, count: int, *, copies: bool, dtype=np.float32) -> AlignmentProblem:
    """Entities made of moved models: exact copies, or boxes and planes with errors."""
    rng = np.random.default_rng(seed)
    rows = [_pair(rng, copies) for _ in range(count)]
    problem = jax.tree.map(lambda *leaves: np.stack(leaves), *rows)
    return jax.tree.map(lambda leaf: leaf if leaf.dtype == bool else leaf.astype(dtype), problem)


def _pair(rng, copy) -> AlignmentProblem:
    model_size = rng.uniform(0.4, 1.2, 3)
    rotation = CUBE_ROTATIONS[rng.integers(24)].astype(float)
    scale, offset = rng.uniform(0.8, 1.3), rng.uniform(-0.75, 0.75)
    box_yaw, support = rng.uniform(-0.78, 0.78), rng.uniform(0, 1)
    size = scale * np.abs(rotation) @ model_size
    center = np.array([*rng.uniform(-3, 3, 2), support + size[2] / 2])
    planes = box_planes(model_size)
    R, p = rotation_z(box_yaw + offset).astype(float) @ rotation, center
    normal = planes.normal @ R.T
    plane_offset = scale * planes.offset - normal @ p
    c, s = abs(np.cos(offset)), abs(np.sin(offset))
    box_size = np.array([c * size[0] + s * size[1], s * size[0] + c * size[1], size[2]])
    if not copy:
        normal += rng.normal(0, 0.03, normal.shape)
        normal /= np.linalg.norm(normal, axis=1, keepdims=True)
        plane_offset += rng.normal(0, 0.02, plane_offset.shape)
        box_size *= rng.uniform(0.9, 1.05, 3)
    if copy:
        center = center + rng.uniform(-0.05, 0.05, 3) * [1, 1, 0]
        box_size = box_size + 0.25 * np.array([1, 1, 0])
    plane_valid = np.arange(6) != 1 if copy else rng.random(6) < 0.7
    supporting = plane_valid & (normal[:, 2] >= DEFAULT_SUPPORT.up_cosine)
    supporting &= (planes.normal @ rotation.T)[:, 2] >= DEFAULT_SUPPORT.up_cosine
    start_scale = size[2] / (np.abs(rotation) @ model_size)[2]
    return AlignmentProblem(
        box=Box(center, np.asarray(box_yaw), box_size),
        support_height_m=np.asarray(support),
        entity_normal=normal,
        entity_offset=plane_offset,
        model_size=model_size,
        model_normal=planes.normal.astype(float),
        model_offset=planes.offset.astype(float),
        plane_valid=plane_valid,
        plane_supporting=supporting,
        rotation=rotation,
        start=np.array([start_scale * rng.uniform(0.9, 1.1), 0, 0, 0]),
        valid=np.asarray(True),
    )


def as_pair(problem: AlignmentProblem, i: int) -> dict[str, np.ndarray]:
    """One lane for the SciPy twin."""
    row = jax.tree.map(lambda leaf: np.asarray(leaf[i], float), problem)
    pair = {f.name: getattr(row, f.name) for f in dataclasses.fields(row) if f.name != "box"}
    pair["start_scale"] = float(row.start[0])
    pair |= {"box_center": row.box.center, "box_yaw": float(row.box.yaw), "box_size": row.box.size}
    return pair


@jax.jit
def cost_and_gradient(problem, weights):
    """(total cost, solution), and the derivatives of the cost by problem and weights."""

    def total(both):
        solution = align(*both)
        return jnp.sum(solution.cost), solution

    return eqx.filter_value_and_grad(total, has_aux=True)((problem, weights))


def one_pose(T, scale) -> AlignmentSolution:
    """A model that stands somewhere, on the axis of `one_pair`."""
    row = jax.tree.map(lambda value: jnp.asarray(value)[None], (T, scale))
    zero = jnp.zeros(1, row[0].dtype)
    whole = jnp.zeros(1, jnp.int32)
    return AlignmentSolution(
        scale=row[1],
        yaw=zero,
        translation=row[0][:, :3, 3],
        T_world_cad=row[0],
        cost=zero,
        status=whole,
        num_steps=whole,
    )


def one_pair(points, triangles) -> SurfacePairs:
    """One entity's points against one model."""
    row = np.zeros(1, np.int32)
    return SurfacePairs(
        points=points[None],
        point_valid=np.ones((1, len(points)), bool),
        triangles=triangles[None],
        triangle_valid=np.ones((1, len(triangles)), bool),
        entity=row,
        model=row,
        valid=np.ones(1, bool),
    )


def table_scene(yaw=0.3, scale=1.1):
    """A floor, a table on it that is a scaled copy of a model, and a box on the table."""
    model = parts_model("table/solid", "table", [((1.0, 0.6, 0.7), (0, 0, 0))])
    size = scale * np.asarray(model.size)
    table = box_entity(2, "table", (1.0, -0.5, size[2] / 2), size, yaw)
    cup = box_entity(3, "cup", (1.0, -0.5, size[2] + 0.05), (0.1, 0.1, 0.1))
    entities = scene_of(floor_entity(), table, cup)
    return entities, support_graph(entities, [ROOM, 0, 1]), library_of(model, table_model())


def rows_of(rows, planes=5) -> Shortlist:
    """A shortlist of (entity, model, rotation), its first planes matched in order."""
    entity, model, rotation = (np.array(c, np.int32) for c in zip(*rows, strict=True))
    # A box's planes: top, bottom, +x, -x, +y, -y; the underside of an entity is not seen.
    match = np.array([0, 2, 3, 4, 5], np.int32)
    match[planes:] = -1
    match = np.tile(match, (len(rows), 1))
    return Shortlist(entity, model, rotation, np.zeros(len(rows), np.float32), match)


def back_of_a_chair():
    """Of a model of seat and back only the back was seen; its box is thin."""
    seat, rest = ((0.4, 0.4, 0.4), (0, 0, -0.2)), ((0.4, 0.04, 0.4), (0, 0.18, 0.2))
    model = parts_model("chair/test", "chair", [seat, rest])
    back = box_entity(2, "chair", (0, 0.18, 0.6), (0.4, 0.04, 0.4))
    box = dataclasses.replace(
        back.box, center=np.float32([0, 0.18, 0.4]), size=np.float32([0.4, 0.04, 0.8])
    )
    entities = scene_of(floor_entity(1), dataclasses.replace(back, box=box))
    return entities, support_graph(entities, [ROOM, 0]), library_of(model)
