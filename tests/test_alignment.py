"""Alignment: exact recovery, parity with SciPy, derivatives, statuses, the alignment error."""

from __future__ import annotations

import dataclasses

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from isr_jax.alignment import (
    AlignmentProblem,
    AlignmentWeights,
    PointSets,
    Surfaces,
    align,
    align_shortlists,
    alignment_error,
    alignment_errors,
    default_start,
)
from isr_jax.config import AlignmentSettings
from isr_jax.geometry import CUBE_ROTATIONS, canonical_box, make_T, rot_z
from isr_jax.types import ROOM, AlignmentStatus, Box, Shortlist

from .builders import (
    box_entity,
    box_mesh,
    box_planes,
    floor_entity,
    library_of,
    parts_model,
    rotation_z,
    scene_of,
    support_graph,
    table_model,
)
from .reference import alignment_reference as reference

EXACT_M = 2e-4
"""Of a float32 solve with a tolerance of 1e-5 and a prior of 1e-2 over coordinates of metres."""
SETTINGS = AlignmentSettings()
WEIGHTS = AlignmentWeights.of(SETTINGS)
ANY_SIZE = dataclasses.replace(WEIGHTS, scale=np.zeros((), np.float32))
"""Copies are scaled at random: no pull to true size."""
LANES = 8
"""Of one shape, so that it compiles once."""
PAPER_STEPS = 500


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
    return AlignmentProblem(
        box=Box(center + (rng.uniform(-0.05, 0.05, 3) * [1, 1, 0] if copy else 0.0),
                np.asarray(box_yaw), box_size + (0.25 * np.array([1, 1, 0]) if copy else 0)),
        support_height_m=np.asarray(support),
        entity_normal=normal,
        entity_offset=plane_offset,
        model_size=model_size,
        model_normal=planes.normal.astype(float),
        model_offset=planes.offset.astype(float),
        plane_valid=np.array([True, False, True, True, True, True])
        if copy else rng.random(6) < 0.7,
        rotation=rotation,
        start=np.array([size[2] / (np.abs(rotation) @ model_size)[2] * rng.uniform(0.9, 1.1),
                        0, 0, 0]),
        valid=np.asarray(True),
    )  # fmt: skip


def as_pair(problem: AlignmentProblem, i: int) -> dict[str, np.ndarray]:
    """One lane for the SciPy twin."""
    row = jax.tree.map(lambda leaf: np.asarray(leaf[i], float), problem)
    pair = {f.name: getattr(row, f.name) for f in dataclasses.fields(row) if f.name != "box"}
    pair["start_scale"] = float(row.start[0])
    pair |= {"box_center": row.box.center, "box_yaw": float(row.box.yaw), "box_size": row.box.size}
    return pair


def weights_as_dict(weights: AlignmentWeights) -> dict[str, float]:
    return {f.name: float(getattr(weights, f.name)) for f in dataclasses.fields(weights)}


@jax.jit
def cost_and_gradient(problem, weights):
    def total(both):
        solution = align(*both)
        return jnp.sum(solution.cost), solution

    return eqx.filter_value_and_grad(total, has_aux=True)((problem, weights))


@pytest.mark.parametrize(("normal_residual", "steps"), [("vector", 64), ("paper", PAPER_STEPS)])
def test_a_moved_copy_is_recovered(normal_residual, steps):
    problem = pairs_of(0, LANES, copies=True)
    solution = align(problem, ANY_SIZE, normal_residual=normal_residual, max_steps=steps)
    assert np.all(solution.status == AlignmentStatus.CONVERGED)
    # Float32 leaves 1 - n . n' = 1e-7, and the prior moves along the flat valley around it.
    angle = 1e-3 if normal_residual == "vector" else 5e-2
    assert np.max(solution.cost) < (1e-3 if normal_residual == "vector" else 2e-2) ** 2
    for i in range(LANES):
        R = np.asarray(solution.T_world_cad[i, :3, :3])
        moved = problem.model_normal[i] @ R.T
        live = problem.plane_valid[i]
        np.testing.assert_allclose(moved[live], problem.entity_normal[i][live], atol=angle)
        center = problem.box.center[i]
        got = solution.scale[i] * problem.model_offset[i] - moved @ (
            solution.translation[i] - center
        )
        meant = problem.entity_offset[i] + problem.entity_normal[i] @ center
        np.testing.assert_allclose(got[live], meant[live], atol=angle)


def test_the_paper_and_the_vector_residual_agree_where_both_are_right():
    problem = pairs_of(1, LANES, copies=True)
    vector = align(problem, WEIGHTS)
    paper = align(problem, WEIGHTS, normal_residual="paper", max_steps=PAPER_STEPS)
    # 1 - n . n' is flat near its minimum: float32 leaves it about sqrt(1e-7) of angle.
    np.testing.assert_allclose(vector.translation, paper.translation, atol=5e-3)
    np.testing.assert_allclose(vector.scale, paper.scale, atol=5e-3)


@pytest.mark.parametrize("seed", range(2))
def test_parity_with_scipy(seed):
    problem = pairs_of(10 + seed, LANES, copies=False)
    solution = align(problem, WEIGHTS)
    assert np.all(solution.status == AlignmentStatus.CONVERGED)
    for i in range(LANES):
        expected, cost = reference.solve(as_pair(problem, i), weights_as_dict(WEIGHTS))
        np.testing.assert_allclose(float(solution.scale[i]), expected[0], atol=1e-3)
        np.testing.assert_allclose(solution.translation[i, :2], expected[2:], atol=2e-3)
        # The cost, unlike the unknowns, is determined to second order.
        np.testing.assert_allclose(float(solution.cost[i]), cost, rtol=1e-3, atol=1e-5)


def test_alignment_follows_a_rigid_motion():
    problem = pairs_of(2, LANES, copies=False)
    # With a side unseen only the weak prior holds the position, to about a centimetre in float32.
    problem = eqx.tree_at(lambda p: p.plane_valid, problem, np.ones((LANES, 6), bool))
    turn, shift = 0.4, np.array([1.5, -2.0, 0.3], np.float32)
    R = rotation_z(turn)
    normal = problem.entity_normal @ R.T
    moved = eqx.tree_at(
        lambda p: (p.box, p.support_height_m, p.entity_normal, p.entity_offset),
        problem,
        (
            Box(problem.box.center @ R.T + shift, problem.box.yaw + turn, problem.box.size),
            problem.support_height_m + shift[2],
            normal,
            problem.entity_offset - normal @ shift,
        ),
    )
    before, after = align(problem, WEIGHTS), align(moved, WEIGHTS)
    np.testing.assert_allclose(after.scale, before.scale, atol=1e-4)
    np.testing.assert_allclose(after.translation, before.translation @ R.T + shift, atol=EXACT_M)
    turned = make_T(R, shift) @ before.T_world_cad
    np.testing.assert_allclose(after.T_world_cad, turned, atol=1e-3)


def test_the_result_stands_on_its_support_with_the_box_of_the_model():
    problem = pairs_of(3, LANES, copies=False)
    solution = align(problem, WEIGHTS)
    for i in range(LANES):
        corners = np.array(np.meshgrid(*[[-0.5, 0.5]] * 3)).reshape(3, -1).T * problem.model_size[i]
        T = np.asarray(solution.T_world_cad[i])
        bottom = (solution.scale[i] * corners @ T[:3, :3].T + T[:3, 3])[:, 2].min()
        np.testing.assert_allclose(bottom, problem.support_height_m[i], atol=1e-5)


def test_a_scale_beyond_the_bound_stays_at_it_and_says_so():
    problem = pairs_of(4, LANES, copies=True)
    grown = eqx.tree_at(lambda p: p.model_size, problem, problem.model_size * 4)
    grown = eqx.tree_at(lambda p: p.model_offset, grown, grown.model_offset * 4)
    solution = align(grown, WEIGHTS)
    assert np.all(solution.status == AlignmentStatus.AT_BOUND)
    np.testing.assert_allclose(solution.scale, 0.5, rtol=1e-2)


def test_a_bad_lane_says_so_and_leaves_the_others_alone():
    problem = pairs_of(5, LANES, copies=False)
    alone = align(problem, WEIGHTS)
    bad = eqx.tree_at(lambda p: p.entity_offset, problem, problem.entity_offset.copy())
    bad.entity_offset[2, 0] = np.nan
    bad.model_size[4] = 0.0

    (_, solution), gradient = cost_and_gradient(bad, WEIGHTS)
    assert list(np.flatnonzero(solution.status == AlignmentStatus.SINGULAR)) == [2, 4]
    assert all(np.all(np.isfinite(leaf)) for leaf in jax.tree.leaves((solution, gradient)))
    good = np.array([0, 1, 3, 5, 6, 7])
    np.testing.assert_array_equal(alone.scale[good], np.asarray(solution.scale)[good])


def test_without_planes_or_prior_the_system_is_singular_and_differentiable():
    """Only the height holds on to anything: yaw and position are free."""
    problem = pairs_of(6, LANES, copies=True)
    loose = eqx.tree_at(lambda p: p.plane_valid, problem, np.zeros_like(problem.plane_valid))
    loose = eqx.tree_at(lambda p: p.box.size, loose, problem.box.size * [3, 3, 1])
    loose = jax.tree.map(lambda a: a.astype(np.float32) if a.dtype == np.float64 else a, loose)
    weights = dataclasses.replace(WEIGHTS, prior=np.zeros((), np.float32))
    solution = align(loose, weights)
    assert np.all(solution.status == AlignmentStatus.SINGULAR)
    _, gradient = cost_and_gradient(loose, weights)
    assert all(np.all(np.isfinite(leaf)) for leaf in jax.tree.leaves(gradient))


def test_too_few_steps_are_reported():
    solution = align(pairs_of(7, LANES, copies=False), WEIGHTS, max_steps=2)
    assert np.all(solution.status == AlignmentStatus.NOT_CONVERGED)


DERIVED = {
    "box size": lambda p, w: p.box.size,
    "box yaw": lambda p, w: p.box.yaw,
    "box center": lambda p, w: p.box.center,
    "support height": lambda p, w: p.support_height_m,
    "normal": lambda p, w: p.entity_normal,
    "offset": lambda p, w: p.entity_offset,
    "model size": lambda p, w: p.model_size,
    "model offset": lambda p, w: p.model_offset,
    "start": lambda p, w: p.start,
    "weights": lambda p, w: (w.normal, w.footprint, w.prior, w.height, w.support, w.offset),
}


def test_derivatives_match_finite_differences():
    with jax.enable_x64(True):
        problem = pairs_of(8, LANES, copies=False, dtype=np.float64)
        weights = jax.tree.map(lambda leaf: leaf.astype(np.float64), WEIGHTS)
        rng = np.random.default_rng(0)

        @jax.jit
        def loss(both):
            solution = align(*both, tolerance=1e-13, max_steps=256)
            pose = jnp.sum(jnp.sin(solution.T_world_cad) * jnp.arange(16.0).reshape(4, 4))
            return pose + jnp.sum(solution.scale) + jnp.sum(solution.cost)

        both = problem, weights
        gradient = eqx.filter_jit(eqx.filter_grad(loss))(both)
        for name, where in DERIVED.items():
            leaves, tree = jax.tree.flatten(where(*both))
            direction = [rng.normal(size=leaf.shape) for leaf in leaves]

            def along(step, where=where, leaves=leaves, tree=tree, direction=direction):
                moved = [v + step * d for v, d in zip(leaves, direction, strict=True)]
                return float(loss(eqx.tree_at(lambda b: where(*b), both, tree.unflatten(moved))))

            slopes = jax.tree.leaves(where(*gradient))
            reverse = sum(np.sum(g * d) for g, d in zip(slopes, direction, strict=True))
            # Accepting steps by their cost finds the unknowns to 1e-8, the root of float64's
            # precision; over the step that is 1e-4. A longer step crosses kinks of hinges.
            h = 2e-4
            wide, narrow = along(2 * h) - along(-2 * h), along(h) - along(-h)
            difference = (8 * narrow - wide) / (12 * h)
            np.testing.assert_allclose(reverse, difference, rtol=1e-3, atol=2e-4, err_msg=name)


def test_start_is_at_equal_heights():
    box = canonical_box(np.array([0, 0, 0.5]), 0.2, np.array([1.0, 0.5, 1.0]))
    start = default_start(box, np.array([0.2, 0.5, 0.4], np.float32), CUBE_ROTATIONS[0])
    np.testing.assert_allclose(start, [2.5, 0, 0, 0], rtol=1e-6)


# The alignment error


def _surface(mesh) -> Surfaces:
    return Surfaces(mesh.vertices[None], mesh.faces[None], np.ones((1, len(mesh.faces)), bool))


def test_alignment_error_of_an_offset_box_is_the_offset():
    mesh = box_mesh((1, 1, 1), spacing_m=0.25)
    top = mesh.vertices[:25] + np.array([0, 0, 0.1], np.float32)
    points = PointSets(top[None], np.ones((1, 25), bool))
    one, zero = np.ones(1, np.float32), np.zeros(1, np.int32)
    error = alignment_error(np.eye(4, dtype=np.float32)[None], one, points, _surface(mesh),
                            zero, zero)  # fmt: skip
    np.testing.assert_allclose(error, [0.1], rtol=1e-5)


def test_alignment_error_parity_with_brute_force():
    rng = np.random.default_rng(3)
    vertices = rng.normal(0, 0.5, (12, 3)).astype(np.float32)
    faces = rng.integers(0, 12, (10, 3)).astype(np.int32)  # some are degenerate on purpose
    faces[0] = [3, 3, 3]
    faces[1] = [4, 5, 5]
    points = rng.normal(0, 0.8, (1, 20, 3)).astype(np.float32)
    T = np.asarray(make_T(rot_z(jnp.asarray(0.7)), jnp.asarray([1.0, 2.0, 0.5])))
    surface = Surfaces(
        np.pad(vertices, ((0, 4), (0, 0)))[None],
        np.pad(faces, ((0, 6), (0, 0)))[None],
        (np.arange(16) < 10)[None],
    )
    sets = PointSets(np.pad(points, ((0, 0), (0, 5), (0, 0))), (np.arange(25) < 20)[None])
    zero = np.zeros(1, np.int32)
    got = alignment_error(T[None], np.array([1.3], np.float32), sets, surface, zero, zero)
    expected = reference.alignment_error(T, 1.3, points[0], vertices, faces)
    np.testing.assert_allclose(got, [expected], rtol=1e-5)


def test_ragged_alignment_errors_are_those_of_the_kernel():
    rng = np.random.default_rng(4)
    meshes = [box_mesh((1, 0.7, 0.5), spacing_m=s) for s in (0.5, 0.05)]
    assert len(meshes[0].faces) < 256 < len(meshes[1].faces)
    points = [rng.normal(0, 0.6, (n, 3)).astype(np.float32) for n in (7, 700)]
    T = np.asarray(make_T(rot_z(jnp.asarray([0.4, -0.9])), jnp.asarray([[1.0, 2, 0], [0, 0, 1]])))
    scale = np.array([0.8, 1.2], np.float32)
    ragged = alignment_errors(T, scale, points, [m.vertices[m.faces] for m in meshes])
    zero = np.zeros(1, np.int32)
    for i in range(2):
        sets = PointSets(points[i][None], np.ones((1, len(points[i])), bool))
        one = alignment_error(T[i : i + 1], scale[i : i + 1], sets, _surface(meshes[i]), zero, zero)
        np.testing.assert_allclose(ragged[i], one[0], rtol=1e-5)


def test_alignment_error_derivative_matches_finite_differences():
    with jax.enable_x64(True):
        mesh = box_mesh((1, 0.8, 0.6), spacing_m=0.3)
        rng = np.random.default_rng(5)
        points = PointSets(rng.normal(0, 0.7, (1, 30, 3)), np.ones((1, 30), bool))
        surface = jax.tree.map(
            lambda a: a.astype(np.float64) if a.dtype == np.float32 else a, _surface(mesh)
        )
        zero = np.zeros(1, np.int32)

        def error(step):
            T = make_T(rot_z(0.3 + step), jnp.array([0.1, 0.2, 0.3]) * (1 + step))
            return alignment_error(T[None], (1.1 + step)[None], points, surface, zero, zero)[0]

        slope = jax.grad(error)(jnp.asarray(0.0))
        difference = (error(jnp.asarray(1e-6)) - error(jnp.asarray(-1e-6))) / 2e-6
        np.testing.assert_allclose(slope, difference, rtol=1e-6)


# Shortlists


def _scene(yaw=0.3, scale=1.1):
    """A floor, a table on it that is a scaled copy of a model, and a box on the table."""
    model = parts_model("table/solid", "table", [((1.0, 0.6, 0.7), (0, 0, 0))])
    size = scale * np.asarray(model.size)
    table = box_entity(2, "table", (1.0, -0.5, size[2] / 2), size, yaw)
    cup = box_entity(3, "cup", (1.0, -0.5, size[2] + 0.05), (0.1, 0.1, 0.1))
    entities = scene_of(floor_entity(), table, cup)
    return entities, support_graph(entities, [ROOM, 0, 1]), library_of(model, table_model())


def _shortlist(rows, planes=5):
    entity, model, rotation = (np.array(c, np.int32) for c in zip(*rows, strict=True))
    # A box's planes: top, bottom, +x, -x, +y, -y; the underside of an entity is not seen.
    match = np.tile(np.array([0, 2, 3, 4, 5][:planes], np.int32), (len(rows), 1))
    return Shortlist(entity, model, rotation, np.zeros(len(rows), np.float32), match)


def test_shortlists_align_an_exact_copy():
    entities, graph, library = _scene()
    shortlist = _shortlist([(1, 0, 0)])
    any_size = dataclasses.replace(SETTINGS, weight_scale=0.0)
    (found,) = align_shortlists([entities], [graph], [shortlist], library, any_size)
    np.testing.assert_allclose(found.scale, [1.1], atol=1e-3)
    np.testing.assert_allclose(found.T_world_cad[0, :3, :3], rotation_z(0.3), atol=1e-3)
    np.testing.assert_allclose(found.translation[0], entities[1].box.center, atol=1e-3)
    assert found.alignment_error_m[0] < EXACT_M


def test_scenes_together_give_what_they_give_alone():
    one, two = _scene(0.3, 1.1), _scene(-0.5, 0.9)
    lists = [_shortlist([(1, 0, 0), (1, 1, 2)]), _shortlist([(1, 0, 2)])]
    empty = _shortlist([(1, 0, 0)])
    empty = Shortlist(*(getattr(empty, f.name)[:0] for f in dataclasses.fields(empty)))
    together = align_shortlists(
        [one[0], one[0], two[0]], [one[1], one[1], two[1]], [lists[0], empty, lists[1]], one[2],
        SETTINGS,
    )  # fmt: skip
    assert [len(a.scale) for a in together] == [2, 0, 1]
    for scene, shortlist, found in zip((one, two), lists, (together[0], together[2]), strict=True):
        (alone,) = align_shortlists([scene[0]], [scene[1]], [shortlist], scene[2], SETTINGS)
        for field in dataclasses.fields(alone):
            a, b = getattr(alone, field.name), getattr(found, field.name)
            np.testing.assert_allclose(a, b, atol=1e-6)


def test_a_child_stands_on_its_parents_plane_and_an_unsupported_thing_on_its_box():
    entities, graph, library = _scene()
    cup = parts_model("cup/test", "cup", [((0.1, 0.1, 0.1), (0, 0, 0))])
    library = library_of(cup, *library.models)
    shortlist = _shortlist([(2, 0, 0)])
    (found,) = align_shortlists([entities], [graph], [shortlist], library, SETTINGS)
    bottom = found.translation[0, 2] - found.scale[0] * 0.05
    np.testing.assert_allclose(bottom, 1.1 * 0.7, atol=1e-5)
    floating = dataclasses.replace(graph, parent=np.array([ROOM, 0, -2]),
                                   support_plane=np.array([-1, 0, -1]))  # fmt: skip
    (alone,) = align_shortlists([entities], [floating], [shortlist], library, SETTINGS)
    np.testing.assert_allclose(alone.translation, found.translation, atol=1e-4)


def _back_of_a_chair():
    """Of a model of seat and back only the back was seen; its box is thin."""
    model = parts_model(
        "chair/test", "chair",
        [((0.4, 0.4, 0.4), (0, 0, -0.2)), ((0.4, 0.04, 0.4), (0, 0.18, 0.2))],
    )  # fmt: skip
    back = box_entity(2, "chair", (0, 0.18, 0.6), (0.4, 0.04, 0.4))
    box = dataclasses.replace(
        back.box, center=np.float32([0, 0.18, 0.4]), size=np.float32([0.4, 0.04, 0.8])
    )
    entities = scene_of(floor_entity(1), dataclasses.replace(back, box=box))
    return entities, support_graph(entities, [ROOM, 0]), library_of(model)


def test_a_model_whose_front_was_hidden_is_put_flush_with_what_was_seen():
    entities, graph, library = _back_of_a_chair()
    alone = _shortlist([(1, 0, 0)])
    rows = [dataclasses.replace(alone, plane_match=np.full_like(alone.plane_match, -1))]
    (found,) = align_shortlists([entities], [graph], rows, library, SETTINGS)
    np.testing.assert_allclose(found.translation[0], [0, 0, 0.4], atol=5e-3)
    assert found.alignment_error_m[0] < 5e-3
    still = dataclasses.replace(SETTINGS, slide_hidden_m=float("inf"))
    (centred,) = align_shortlists([entities], [graph], rows, library, still)
    assert centred.alignment_error_m[0] > 0.05
