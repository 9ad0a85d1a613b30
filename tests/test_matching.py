"""Matching: parity with a slow twin, exactness of the assignment, and invariances."""

from __future__ import annotations

import dataclasses

import jax
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import cKDTree

from isr_jax.config import MatchingSettings, SupportSettings, preset
from isr_jax.geometry import CUBE_ROTATIONS, canonical_box, transform_planes
from isr_jax.library import CadModel
from isr_jax.matching import assignment_cost, match, matching_errors
from isr_jax.matching.queries import entity_rows
from isr_jax.types import ROOM, UNSUPPORTED, Box, ContactGraph, Entities, Entity, Mesh, PlaneSet

from .builders import (
    box_entity,
    floor_entity,
    library_of,
    parts_model,
    planes_that_count,
    scene_of,
    support_graph,
    table_model,
)
from .furniture import block_model, bookshelf_model, chair_model
from .reference import matching_reference as slow
from .reference.geometry_reference import rotation_z

DEFAULT = MatchingSettings()
UP = SupportSettings.up_cosine
ERROR = 2e-5
"""Eight summands of order 1 in float32, each from products of coordinates of metres."""

_cost = jax.jit(assignment_cost)


def graph_of(scene: Entities, parent: dict[int, tuple[int, int]] | None = None) -> ContactGraph:
    """A graph with boxes as they are; ``parent`` maps a child to (position, plane)."""
    parents = np.array([ROOM if e.is_layout else UNSUPPORTED for e in scene], np.int32)
    planes = np.full(len(parents), -1, np.int32)
    for child, (position, plane) in (parent or {}).items():
        parents[child], planes[child] = position, plane
    return support_graph(scene, parents, planes, score=parents >= 0)


def copy_of(
    model: CadModel,
    *,
    rotation: int = 0,
    yaw: float = 0.0,
    scale: float = 1.0,
    shift=(0.0, 0.0, 0.0),
    id: int = 2,
    planes: int = 8,
) -> Entity:
    """An entity that is a scaled and turned copy of a model, with its largest planes seen."""
    turn = (rotation_z(yaw) @ CUBE_ROTATIONS[rotation]).astype(np.float32)
    shift, area = np.asarray(shift, np.float32), np.asarray(model.planes.area_m2)
    of = model.planes
    largest = np.argsort(-area, kind="stable")[:planes]
    seen = np.intersect1d(largest, planes_that_count(of, model.plane_supporting))
    factor = np.asarray(scale, np.float32)
    normal, offset = transform_planes(factor, turn, shift, of.normal[seen], of.offset[seen])
    corners = scale * of.corners[seen] @ turn.T + shift
    size = scale * np.abs(CUBE_ROTATIONS[rotation]) @ model.size
    moved = scale * model.mesh.vertices @ turn.T + shift
    return Entity(
        id=id,
        name=f"{model.class_name}_{id}",
        class_name=model.class_name,
        box=canonical_box(shift, yaw, size),
        planes=PlaneSet(
            np.asarray(normal),
            np.asarray(offset),
            corners.astype(np.float32),
            (scale**2 * of.area_m2[seen]).astype(np.float32),
            np.ones(len(seen), bool),
        ),
        mesh=Mesh(moved.astype(np.float32), model.mesh.faces),
        is_layout=False,
    )


def seats_and_tables():
    return library_of(
        table_model(),
        table_model("table/low", (1.1, 0.6, 0.45)),
        table_model("table/square", (0.9, 0.9, 0.75)),
        block_model("table/block", (1.2, 0.7, 0.7)),
        chair_model(),
        block_model("chair/stool", (0.4, 0.4, 0.5)),
        bookshelf_model(),
    )


def noisy_scene(seed: int) -> tuple[Entities, ContactGraph]:
    """Entities like the models of the library, with noise on boxes and planes."""
    rng = np.random.default_rng(seed)
    library, items = seats_and_tables(), [floor_entity(1)]
    for i, model in enumerate(library.models):
        turned = copy_of(
            model,
            rotation=int(rng.integers(24)),
            yaw=rng.uniform(-3, 3),
            scale=rng.uniform(0.8, 1.2),
            shift=rng.uniform(-2, 2, 3),
            id=i + 2,
            planes=int(rng.integers(2, 9)),
        )
        normal = turned.planes.normal + rng.normal(0, 0.05, turned.planes.normal.shape)
        normal = (normal / np.linalg.norm(normal, axis=-1, keepdims=True)).astype(np.float32)
        size = (turned.box.size * rng.uniform(0.9, 1.1, 3)).astype(np.float32)
        planes = dataclasses.replace(turned.planes, normal=normal)
        box = Box(turned.box.center, turned.box.yaw, size)
        items.append(dataclasses.replace(turned, planes=planes, box=box))
    scene = scene_of(*items)
    ups = [np.flatnonzero(e.planes.normal[:, 2] >= UP) for e in items]
    carrier = next((i for i, up in enumerate(ups) if i and len(up)), None)
    children = {} if carrier is None else {0: (carrier, int(ups[carrier][0]))}
    return scene, graph_of(scene, children)


def random_costs(rng, rows: int, columns: int, batch: int):
    cost = rng.uniform(0, 2, (rows, columns, batch)).astype(np.float32)
    cost[rng.random(cost.shape) < 0.2] = np.inf
    unmatched = rng.choice([0.5, 1.0, np.inf], (rows, batch)).astype(np.float32)
    return cost, unmatched


@pytest.mark.parametrize(("rows", "columns"), [(1, 1), (3, 2), (2, 5), (4, 4)])
def test_assignment_is_the_best_of_all_ways(rows, columns):
    cost, unmatched = random_costs(np.random.default_rng(rows), rows, columns, 20)
    expected = [slow.assignment_by_trial(cost[..., i], unmatched[:, i]) for i in range(20)]
    np.testing.assert_allclose(_cost(cost, unmatched), expected, atol=ERROR)


def test_an_assignment_that_cannot_be_is_inf():
    both_must_take_one = np.full((2, 1, 1), 0.3, np.float32), np.full((2, 1), np.inf, np.float32)
    assert np.isinf(_cost(*both_must_take_one))[0]


@pytest.mark.parametrize(("rows", "columns"), [(4, 8), (6, 16), (8, 16)])
def test_assignment_agrees_with_scipy(rows, columns):
    cost, unmatched = random_costs(np.random.default_rng(rows), rows, columns, 100)
    expected = [slow.assignment(cost[..., i], unmatched[:, i]) for i in range(100)]
    np.testing.assert_allclose(_cost(cost, unmatched), expected, atol=ERROR)


@settings(max_examples=20, deadline=None, derandomize=True)
@given(st.integers(0, 10_000))
def test_assignment_does_not_depend_on_the_order_of_columns(seed):
    rng = np.random.default_rng(seed)
    cost, unmatched = random_costs(rng, 4, 6, 5)
    shuffled = cost[:, rng.permutation(6)]
    np.testing.assert_allclose(_cost(cost, unmatched), _cost(shuffled, unmatched), atol=ERROR)


@pytest.mark.parametrize("matching", [DEFAULT, preset("paper").matching], ids=["default", "paper"])
@pytest.mark.parametrize("seed", range(2))
def test_errors_agree_with_twin(seed, matching):
    scene, graph = noisy_scene(seed)
    library = seats_and_tables()
    every = dataclasses.replace(matching, shortlist=10_000, merge_symmetric=False)
    found = match([scene], [graph], library, every)[0]
    for position, entity in enumerate(scene):
        models = library.matching_class(entity.class_name)
        chosen = [library[int(m)] for m in models]
        carrying = np.unique(graph.support_plane[graph.children(position)])
        rows = entity_rows(entity.planes, carrying)
        columns = [planes_that_count(m.planes, m.plane_supporting) for m in chosen]
        table = slow.all_errors(
            entity.box, entity.planes, rows, set(carrying), chosen, columns, every, UP
        )
        ours = found.entity == position
        measured = np.full(table.shape, np.inf)
        slot = np.searchsorted(models, found.model[ours])
        measured[slot, found.rotation[ours]] = found.error[ours]
        np.testing.assert_allclose(measured, table, atol=ERROR)


def test_plane_match_has_the_cost_that_the_kernel_found():
    """Adding up the matched pairs gives back D, and f is one-to-one."""
    library = seats_and_tables()
    for seed in range(3):
        scene, graph = noisy_scene(seed)
        found = match([scene], [graph], library, DEFAULT)[0]
        for row in range(len(found.error)):
            entity, model = scene[int(found.entity[row])], library[int(found.model[row])]
            turn, f = CUBE_ROTATIONS[found.rotation[row]].astype(float), found.plane_match[row]
            assert f.shape == (8,)
            partners = f[f >= 0]
            assert len(partners) == len(set(partners.tolist()))
            rows, columns = range(len(entity.planes.offset)), range(len(model.planes.offset))
            args = entity.box, entity.planes, rows, model, columns, turn, UP
            cost = slow.plane_costs(*args)
            d_pi = sum(cost[i, f[i]] if f[i] >= 0 else DEFAULT.unmatched_cost for i in rows)
            alone = slow.matching_error(
                entity.box, entity.planes, [], set(), model, [], turn, DEFAULT, UP
            )
            assert found.error[row] == pytest.approx(alone + d_pi, abs=ERROR)


@pytest.mark.parametrize("rotation", [0, 1, 3, 9, 17])
def test_the_true_model_wins_in_its_orientation(rotation):
    """Without the bias towards upright models: with it, an upright near-fit may cost less."""
    library, unbiased = seats_and_tables(), dataclasses.replace(DEFAULT, weight_upright=0.0)
    for number, model in enumerate(library.models):
        entity = copy_of(model, rotation=rotation, yaw=0.3, scale=1.3, shift=(1.0, 2.0, 0.5))
        scene = scene_of(floor_entity(1), entity)
        found = match([scene], [graph_of(scene)], library, unbiased)[0]
        assert found.model[0] == number, model.id
        assert found.error[0] == pytest.approx(0.0, abs=ERROR)
        # Symmetric models fit in more than one orientation: all that fill the same space.
        turn = rotation_z(float(entity.box.yaw)) @ CUBE_ROTATIONS[found.rotation[0]]
        placed = 1.3 * model.mesh.vertices @ turn.T + (1.0, 2.0, 0.5)
        gaps = cKDTree(entity.mesh.vertices).query(placed)[0]
        assert gaps.max() < 1e-4, model.id


def test_upright_models_are_preferred():
    """A cube without planes fits in every rotation; the bias alone decides: w_b (1 + g . z)."""
    cube = dataclasses.replace(block_model("bin/cube", (0.3, 0.3, 0.3)), symmetry=1)
    scene, every = scene_of(copy_of(cube, planes=0)), dataclasses.replace(DEFAULT, shortlist=24)
    found = match([scene], [graph_of(scene)], library_of(cube), every)[0]
    tilt = 1 - CUBE_ROTATIONS[found.rotation][:, 2, 2]
    np.testing.assert_allclose(found.error, DEFAULT.weight_upright * tilt, atol=ERROR)
    assert np.all(np.diff(tilt) >= 0) and tilt[-1] == 2


@settings(max_examples=8, deadline=None, derandomize=True)
@given(yaw=st.floats(-3.1, 3.1), x=st.floats(-5, 5), y=st.floats(-5, 5), seed=st.integers(0, 5))
def test_errors_follow_no_rigid_motion_of_the_scene(yaw, x, y, seed):
    """Turned about up and shifted, an entity has the same errors with the same models."""
    library, model = seats_and_tables(), chair_model()
    plain = copy_of(model, rotation=seed, yaw=0.0)
    moved = copy_of(model, rotation=seed, yaw=yaw, shift=(x, y, 0.3))
    every = dataclasses.replace(DEFAULT, shortlist=100, merge_symmetric=False)
    scenes = [scene_of(plain), scene_of(moved)]
    a, b = match(scenes, [graph_of(s) for s in scenes], library, every)
    for m in np.unique(a.model):
        errors = np.sort(a.error[a.model == m]), np.sort(b.error[b.model == m])
        np.testing.assert_allclose(*errors, atol=ERROR)


def test_errors_do_not_depend_on_scale():
    library = seats_and_tables()
    scenes = [scene_of(copy_of(table_model(), scale=s)) for s in (1.0, 0.4)]
    a, b = match(scenes, [graph_of(s) for s in scenes], library, DEFAULT)
    np.testing.assert_array_equal(a.model, b.model)
    np.testing.assert_allclose(a.error, b.error, atol=ERROR)


def test_renaming_models_permutes_the_result():
    scene, graph = noisy_scene(1)
    first = seats_and_tables()
    renamed = [
        dataclasses.replace(m, id=f"{m.class_name}/{9 - i}") for i, m in enumerate(first.models)
    ]
    second = library_of(*renamed)
    back = {m.id: i for i, m in enumerate(renamed)}
    assert [back[m.id] for m in second.models] != list(range(len(first)))
    every = dataclasses.replace(DEFAULT, shortlist=10_000)
    a, b = (match([scene], [graph], lib, every)[0] for lib in (first, second))
    to_first = np.array([back[m.id] for m in second.models])
    ours = {k: e for *k, e in zip(a.entity, a.model, a.rotation, a.error) for k in [tuple(k)]}
    for e, m, r, error in zip(b.entity, to_first[b.model], b.rotation, b.error, strict=True):
        assert ours[e, m, r] == pytest.approx(error, abs=ERROR)


def test_shortlists_are_sorted_and_bounded_and_break_ties_in_order():
    scene, graph = noisy_scene(2)
    found = match([scene], [graph], seats_and_tables(), DEFAULT)[0]
    assert np.all(np.diff(found.entity) >= 0)
    for position in np.unique(found.entity):
        errors = found.error[found.entity == position]
        assert len(errors) <= DEFAULT.shortlist + 3 * DEFAULT.turned_models
        assert np.all(np.diff(errors) >= -1e-5)
    cube = dataclasses.replace(block_model("bin/cube", (0.3, 0.3, 0.3)), symmetry=1)
    bare = scene_of(copy_of(cube, planes=0))
    ties = match([bare], [graph_of(bare)], library_of(cube), DEFAULT)[0]
    np.testing.assert_array_equal(ties.rotation[:4], [0, 1, 2, 3])  # upright first


@pytest.mark.parametrize(("symmetry", "upright"), [(1, 4), (2, 2), (4, 1), (0, 1)])
def test_equal_rotations_of_a_symmetric_model_take_one_place(symmetry, upright):
    model = dataclasses.replace(block_model("bin/cube", (0.3, 0.3, 0.3)), symmetry=symmetry)
    scene, every = scene_of(copy_of(model)), dataclasses.replace(DEFAULT, shortlist=24)
    found = match([scene], [graph_of(scene)], library_of(model), every)[0]
    assert np.sum(found.rotation < 4) == upright
    assert len(found.rotation) == 6 * upright


def test_who_gets_no_rows():
    scene = scene_of(
        floor_entity(1),
        box_entity(2, "cup", (0, 0, 0.8), (0.08, 0.08, 0.1)),  # no model of its class
        box_entity(3, "bench", (1, 0, 0.2), (1, 0.4, 0.4)),  # not functional
        box_entity(4, "desk", (1, 0, 0.2), (1, 0.4, 0.4)),  # matches tables
    )
    found = match([scene], [graph_of(scene)], seats_and_tables(), DEFAULT)[0]
    assert set(found.entity.tolist()) == {3}
    models = [seats_and_tables()[int(m)] for m in found.model]
    assert {m.class_name for m in models} == {"table"}


def test_a_plane_that_carries_a_child_must_find_a_partner():
    """A table that carries a cup is never matched to one whose top would not face up."""
    library = library_of(table_model(), block_model("table/block", (1.2, 0.8, 0.74)))
    bare = dataclasses.replace(library[0], planes=_only(library[0].planes, slice(1, 6)))
    library = library_of(dataclasses.replace(bare, plane_supporting=np.zeros(5, bool)), library[1])
    table = box_entity(2, "table", (0, 0, 0.37), (1.2, 0.8, 0.74), faces=(0, 2))
    scene = scene_of(floor_entity(1), table, box_entity(3, "cup", (0, 0, 0.79), (0.1,) * 3))
    every = dataclasses.replace(DEFAULT, shortlist=100, merge_symmetric=False)
    free = match([scene], [graph_of(scene)], library, every)[0]
    held = match([scene], [graph_of(scene, {2: (1, 0)})], library, every)[0]
    assert len(free.error) == 48 and 24 <= len(held.error) < 48
    assert np.all(held.plane_match[:, 0] >= 0)
    for row in range(len(held.error)):
        planes = library[int(held.model[row])].planes
        up = CUBE_ROTATIONS[held.rotation[row]] @ planes.normal[held.plane_match[row, 0]]
        assert up[2] >= UP


def _only(planes: PlaneSet, rows) -> PlaneSet:
    return jax.tree.map(lambda leaf: leaf[rows], planes)


def test_unmatched_planes_cost_or_reject():
    """Six faces of a block against a model with five planes: one stays alone."""
    full = block_model("bin/full", (0.4, 0.3, 0.5))
    open_top = _only(full.planes, slice(1, 6))
    model = dataclasses.replace(full, planes=open_top, plane_supporting=np.zeros(5, bool))
    scene, library = scene_of(copy_of(full)), library_of(model)
    found = match([scene], [graph_of(scene)], library, DEFAULT)[0]
    assert found.error[0] == pytest.approx(DEFAULT.unmatched_cost, abs=ERROR)
    assert np.sum(found.plane_match[0] >= 0) == 5
    rejected = match([scene], [graph_of(scene)], library, preset("paper").matching)[0]
    assert len(rejected.error) == 0 and rejected.plane_match.shape == (0, 8)


def test_a_weight_of_zero_is_finite():
    scene, library = scene_of(copy_of(table_model())), seats_and_tables()
    blind = dataclasses.replace(preset("paper").matching, weight_planes=0.0)
    found = match([scene], [graph_of(scene)], library, blind)[0]
    assert len(found.error) and np.all(np.isfinite(found.error))


def test_of_many_planes_those_that_carry_and_the_largest_count():
    entity = copy_of(table_model())
    many = jax.tree.map(lambda leaf: np.concatenate([leaf] * 2), table_model().planes)
    smallest = int(np.argmin(many.area_m2))
    rows = entity_rows(many, np.array([smallest]))
    assert len(rows) == 8 and smallest in rows
    kept, every = np.setdiff1d(rows, [smallest]), np.arange(len(many.offset))
    rest = np.setdiff1d(every, rows)
    assert many.area_m2[kept].min() >= many.area_m2[rest].max() - 1e-6
    scene = scene_of(dataclasses.replace(entity, planes=many))
    found = match([scene], [graph_of(scene)], seats_and_tables(), DEFAULT)[0]
    assert found.plane_match.shape[1] == len(many.offset)
    unused = np.setdiff1d(every, entity_rows(many, np.zeros(0, np.int32)))
    assert np.all(found.plane_match[:, unused] == -1)


def test_of_a_models_many_planes_supporting_ones_stay():
    model = table_model()
    columns = planes_that_count(model.planes, model.plane_supporting)
    assert len(model.planes.offset) == 30 and len(columns) == 16
    assert set(np.flatnonzero(model.plane_supporting)) <= set(columns.tolist())


def test_scenes_together_are_scenes_alone():
    made = [noisy_scene(seed) for seed in range(3)]
    scenes, graphs = (list(side) for side in zip(*made, strict=True))
    scenes.append(scene_of(floor_entity(1)))
    graphs.append(graph_of(scenes[-1]))
    together = match(scenes, graphs, seats_and_tables(), DEFAULT)
    for scene, graph, found in zip(scenes, graphs, together, strict=True):
        alone = match([scene], [graph], seats_and_tables(), DEFAULT)[0]
        for field in dataclasses.fields(alone):
            np.testing.assert_array_equal(getattr(found, field.name), getattr(alone, field.name))


def test_an_empty_library_gives_empty_shortlists():
    scene, graph = noisy_scene(0)
    found = match([scene], [graph], library_of(), DEFAULT)[0]
    assert len(found.entity) == 0 and found.plane_match.shape == (0, 8)


def test_a_second_scene_compiles_nothing_new():
    library = seats_and_tables()
    made = [noisy_scene(seed) for seed in (0, 1, 2)]
    match([s for s, _ in made], [g for _, g in made], library, DEFAULT)
    before = matching_errors._cache_size()
    other = dataclasses.replace(DEFAULT, weight_planes=0.7, unmatched_cost=1.5)
    for seed in (5, 6):
        scene, graph = noisy_scene(seed)
        match([scene], [graph], library_of(*library.models, parts_model(*TALL)), other)
    assert matching_errors._cache_size() == before > 0


TALL = ("table/tall", "table", [((0.6, 0.6, 1.1), (0.0, 0.0, 0.0))])


@pytest.mark.parametrize("distance_m", [0.1, 1.0])
def test_backs_go_to_the_wall(distance_m):
    """A box without planes looks the same from both sides; a wall beside it decides, if near."""
    model = dataclasses.replace(block_model("cabinet/test", (0.8, 0.4, 0.9)), symmetry=1)
    yaw, normal = 0.4, rotation_z(0.4) @ np.array([0.0, -1.0, 0.0])
    center = -normal * (0.2 + distance_m + 0.01)
    wall = box_entity(9, "wall", (*center[:2], 1.25), (4.0, 0.02, 2.5), yaw, faces=(5,))
    cabinet = copy_of(model, yaw=yaw, shift=(0, 0, 0.45), planes=0)
    scene = scene_of(wall, cabinet)
    every = dataclasses.replace(DEFAULT, shortlist=24)
    found = match([scene], [graph_of(scene)], library_of(model), every)[0]
    near = distance_m < DEFAULT.wall_distance_m
    table = slow.all_errors(
        cabinet.box, cabinet.planes, [], set(), [model], [[]], every, UP, normal if near else None
    )
    np.testing.assert_allclose(found.error, table[0, found.rotation], atol=ERROR)
    away = found.error[found.rotation == 2] - found.error[found.rotation == 0]
    np.testing.assert_allclose(away, 2 * DEFAULT.weight_wall * near, atol=ERROR)


def test_the_best_models_come_in_every_upright_turn():
    scene, graph = noisy_scene(1)
    few = dataclasses.replace(DEFAULT, shortlist=3, turned_models=2, merge_symmetric=False)
    found = match([scene], [graph], seats_and_tables(), few)[0]
    for position in np.unique(found.entity):
        ours = found.entity == position
        models, turns = found.model[ours], found.rotation[ours]
        first = list(dict.fromkeys(models[:3].tolist()))[:2]
        for model in first:
            assert {0, 1, 2, 3} <= set(turns[models == model].tolist())
        assert np.sum(ours) <= 3 + 4 * 2


def mounted(cad_id: str, mount: str, size=(0.2, 0.2, 0.3)) -> CadModel:
    return dataclasses.replace(block_model(cad_id, size), mount=mount)


LAMPS = (
    mounted("lamp/desk", "surface"),
    mounted("lamp/floor", "floor", (0.4, 0.4, 1.5)),
    mounted("lamp/wall", "wall"),
)
OVENS = (mounted("oven/free", "floor"), mounted("oven/built_in", "opening"))


@pytest.mark.parametrize(
    ("models", "class_name", "attachment", "carried", "expected"),
    [
        (LAMPS, "lamp", "none", True, {"lamp/desk", "lamp/floor"}),
        (LAMPS, "lamp", "none", False, {"lamp/desk", "lamp/floor"}),
        (LAMPS, "lamp", "leaning", False, {"lamp/desk", "lamp/floor"}),
        (LAMPS, "lamp", "wall", False, {"lamp/wall"}),
        (LAMPS, "lamp", "hanging", False, {"lamp/desk", "lamp/floor", "lamp/wall"}),
        (LAMPS[:2], "lamp", "wall", False, {"lamp/desk", "lamp/floor"}),  # none hangs
        (LAMPS[2:], "lamp", "none", True, set()),  # nothing stands
        (OVENS, "oven", "none", True, {"oven/free"}),
        (OVENS, "oven", "none", False, {"oven/free", "oven/built_in"}),
        # classes that hang by themselves are as they were
        ((mounted("wall_cabinet/a", "wall"),), "wall_cabinet", "none", True, {"wall_cabinet/a"}),
        ((mounted("wall_cabinet/a", "wall"),), "wall_cabinet", "wall", False, {"wall_cabinet/a"}),
        ((mounted("door/a", "opening"),), "door", "wall", False, {"door/a"}),
    ],
)
def test_models_are_tried_where_they_can_be_mounted(
    models, class_name, attachment, carried, expected
):
    table = box_entity(2, "table", (0, 0, 0.4), (1.2, 0.8, 0.8))
    thing = box_entity(3, class_name, (0, 0, 0.95), (0.2, 0.2, 0.3))
    scene = scene_of(floor_entity(1), table, thing)
    graph = graph_of(scene, {2: (1, 0)} if carried else {})
    graph = dataclasses.replace(graph, attachment=("none", "none", attachment))
    library = library_of(*models)
    found = match([scene], [graph], library, DEFAULT)[0]
    assert {library[int(m)].id for m in found.model} == expected
