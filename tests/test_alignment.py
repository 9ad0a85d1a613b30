"""Alignment: exact recovery, parity with SciPy, derivatives, statuses, the alignment error."""

from __future__ import annotations

import dataclasses

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np
import pytest

from isr_jax.alignment import (
    AlignmentWeights,
    align,
    align_shortlists,
    alignment_error,
    alignment_errors,
    default_start,
    problem_of,
    solve,
    surfaces_of,
)
from isr_jax.alignment.solve import cost_at
from isr_jax.config import AlignmentSettings, Settings, SupportSettings, with_overrides
from isr_jax.errors import LibraryError, SettingError
from isr_jax.geometry import CUBE_ROTATIONS, canonical_box, make_T, rot_z
from isr_jax.types import ROOM, UNSUPPORTED, AlignmentStatus, Box, Shortlist

from .alignment_pairs import (
    LANES,
    SETTINGS,
    WEIGHTS,
    as_pair,
    back_of_a_chair,
    cost_and_gradient,
    one_pair,
    one_pose,
    pairs_of,
    rows_of,
    table_scene,
)
from .builders import (
    box_mesh,
    library_of,
    parts_model,
    rotation_z,
    scene_of,
    support_graph,
)
from .reference import alignment_reference as reference

EXACT_M = 2e-4
"""Of a float32 solve with a tolerance of 1e-5 and a prior of 1e-2 over coordinates of metres."""
BOUNDS = SETTINGS.scale_min, SETTINGS.scale_max
ANY_SIZE = dataclasses.replace(WEIGHTS, scale=np.zeros((), np.float32))
"""Copies are scaled at random: no pull to true size."""
PAPER = dataclasses.replace(SETTINGS, normal_residual="paper", max_steps=500)


def weights_as_dict(weights: AlignmentWeights) -> dict[str, float]:
    return {f.name: float(getattr(weights, f.name)) for f in dataclasses.fields(weights)}


@pytest.mark.parametrize("settings", [SETTINGS, PAPER], ids=["vector", "paper"])
def test_a_moved_copy_is_recovered(settings):
    problem = pairs_of(0, LANES, copies=True)
    solution = align(problem, ANY_SIZE, settings)
    assert np.all(solution.status == AlignmentStatus.CONVERGED)
    # Float32 leaves 1 - n . n' = 1e-7, and the prior moves along the flat valley around it.
    vector = settings.normal_residual == "vector"
    angle = 1e-3 if vector else 5e-2
    assert np.max(solution.cost) < (1e-3 if vector else 2e-2) ** 2
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
    paper = align(problem, WEIGHTS, PAPER)
    # 1 - n . n' is flat near its minimum: float32 leaves it about sqrt(1e-7) of angle.
    np.testing.assert_allclose(vector.translation, paper.translation, atol=5e-3)
    np.testing.assert_allclose(vector.scale, paper.scale, atol=5e-3)


@pytest.mark.parametrize("seed", range(2))
def test_parity_with_scipy(seed):
    problem = pairs_of(10 + seed, LANES, copies=False)
    solution = align(problem, WEIGHTS)
    assert np.all(solution.status == AlignmentStatus.CONVERGED)
    for i in range(LANES):
        expected, cost = reference.solve(as_pair(problem, i), weights_as_dict(WEIGHTS), BOUNDS)
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
    grown = eqx.tree_at(lambda p: p.model_size, problem, problem.model_size * 3)
    grown = eqx.tree_at(lambda p: p.model_offset, grown, grown.model_offset * 3)
    solution = align(grown, WEIGHTS)
    assert np.all(solution.status == AlignmentStatus.AT_BOUND)
    np.testing.assert_allclose(solution.scale, SETTINGS.scale_min, rtol=1e-2)


def test_a_bad_lane_says_so_and_leaves_the_others_alone():
    problem = pairs_of(5, LANES, copies=False)
    (_, alone), _ = cost_and_gradient(problem, WEIGHTS)
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
    solution = align(
        pairs_of(7, LANES, copies=False), WEIGHTS, dataclasses.replace(SETTINGS, max_steps=2)
    )
    assert np.all(solution.status == AlignmentStatus.NOT_CONVERGED)


def test_start_is_at_equal_heights():
    box = canonical_box(np.array([0, 0, 0.5]), 0.2, np.array([1.0, 0.5, 1.0]))
    start = default_start(box, np.array([0.2, 0.5, 0.4], np.float32), CUBE_ROTATIONS[0])
    np.testing.assert_allclose(start, [2.5, 0, 0, 0], rtol=1e-6)


# The alignment error


def test_alignment_error_of_an_offset_box_is_the_offset():
    mesh = box_mesh((1, 1, 1), spacing_m=0.25)
    top = mesh.vertices[:25] + np.array([0, 0, 0.1], np.float32)
    pair = one_pair(top, mesh.vertices[mesh.faces])
    error = alignment_error(one_pose(np.eye(4, dtype=np.float32), np.float32(1.0)), pair)
    np.testing.assert_allclose(error, [0.1], rtol=1e-5)


def test_alignment_error_parity_with_brute_force():
    rng = np.random.default_rng(3)
    vertices = rng.normal(0, 0.5, (12, 3)).astype(np.float32)
    faces = rng.integers(0, 12, (10, 3)).astype(np.int32)  # some are degenerate on purpose
    faces[0] = [3, 3, 3]
    faces[1] = [4, 5, 5]
    points = rng.normal(0, 0.8, (20, 3)).astype(np.float32)
    T = np.asarray(make_T(rot_z(jnp.asarray(0.7)), jnp.asarray([1.0, 2.0, 0.5])))
    padded = one_pair(
        np.pad(points, ((0, 5), (0, 0))), np.pad(vertices[faces], ((0, 6), (0, 0), (0, 0)))
    )
    padded = dataclasses.replace(
        padded,
        point_valid=(np.arange(25) < 20)[None],
        triangle_valid=(np.arange(16) < 10)[None],
    )
    got = alignment_error(one_pose(T, np.float32(1.3)), padded)
    expected = reference.alignment_error(T, 1.3, points, vertices, faces)
    np.testing.assert_allclose(got, [expected], rtol=1e-5)


def test_ragged_alignment_errors_are_those_of_the_kernel():
    rng = np.random.default_rng(4)
    meshes = [box_mesh((1, 0.7, 0.5), spacing_m=s) for s in (0.5, 0.05)]
    assert len(meshes[0].faces) < 256 < len(meshes[1].faces)
    points = [rng.normal(0, 0.6, (n, 3)).astype(np.float32) for n in (7, 700)]
    T = np.asarray(make_T(rot_z(jnp.asarray([0.4, -0.9])), jnp.asarray([[1.0, 2, 0], [0, 0, 1]])))
    scale = np.array([0.8, 1.2], np.float32)
    ragged = alignment_errors(T, scale, points, [m.vertices[m.faces] for m in meshes])
    for i in range(2):
        pair = one_pair(points[i], meshes[i].vertices[meshes[i].faces])
        one = alignment_error(one_pose(T[i], scale[i]), pair)
        np.testing.assert_allclose(ragged[i], one[0], rtol=1e-5)


# Shortlists


def test_shortlists_align_an_exact_copy():
    entities, graph, library = table_scene()
    shortlist = rows_of([(1, 0, 0)])
    any_size = dataclasses.replace(SETTINGS, weight_scale=0.0)
    (found,) = align_shortlists([entities], [graph], [shortlist], library, any_size)
    np.testing.assert_allclose(found.scale, [1.1], atol=1e-3)
    np.testing.assert_allclose(found.T_world_cad[0, :3, :3], rotation_z(0.3), atol=1e-3)
    np.testing.assert_allclose(found.translation[0], entities[1].box.center, atol=1e-3)
    assert found.alignment_error_m[0] < EXACT_M


def test_scenes_together_give_what_they_give_alone():
    one, two = table_scene(0.3, 1.1), table_scene(-0.5, 0.9)
    lists = [rows_of([(1, 0, 0), (1, 1, 2)]), rows_of([(1, 0, 2)])]
    empty = rows_of([(1, 0, 0)])
    empty = Shortlist(*(getattr(empty, f.name)[:0] for f in dataclasses.fields(empty)))
    together = align_shortlists(
        [one[0], one[0], two[0]],
        [one[1], one[1], two[1]],
        [lists[0], empty, lists[1]],
        one[2],
        SETTINGS,
    )
    assert [len(a.scale) for a in together] == [2, 0, 1]
    for scene, shortlist, found in zip((one, two), lists, (together[0], together[2]), strict=True):
        (alone,) = align_shortlists([scene[0]], [scene[1]], [shortlist], scene[2], SETTINGS)
        for field in dataclasses.fields(alone):
            a, b = getattr(alone, field.name), getattr(found, field.name)
            np.testing.assert_allclose(a, b, atol=1e-6)


def test_a_child_stands_on_its_parents_plane_and_an_unsupported_thing_on_its_box():
    entities, graph, library = table_scene()
    cup = parts_model("cup/test", "cup", [((0.1, 0.1, 0.1), (0, 0, 0))])
    library = library_of(cup, *library.models)
    shortlist = rows_of([(2, 0, 0)])
    (found,) = align_shortlists([entities], [graph], [shortlist], library, SETTINGS)
    bottom = found.translation[0, 2] - found.scale[0] * 0.05
    np.testing.assert_allclose(bottom, 1.1 * 0.7, atol=1e-5)
    floating = support_graph(entities, [ROOM, 0, UNSUPPORTED])
    (alone,) = align_shortlists([entities], [floating], [shortlist], library, SETTINGS)
    np.testing.assert_allclose(alone.translation, found.translation, atol=1e-4)


def test_a_model_whose_front_was_hidden_is_put_flush_with_what_was_seen():
    entities, graph, library = back_of_a_chair()
    rows = [rows_of([(1, 0, 0)], planes=0)]
    (found,) = align_shortlists([entities], [graph], rows, library, SETTINGS)
    np.testing.assert_allclose(found.translation[0], [0, 0, 0.4], atol=5e-3)
    assert found.alignment_error_m[0] < 5e-3
    still = dataclasses.replace(SETTINGS, slide_hidden_m=float("inf"))
    (centred,) = align_shortlists([entities], [graph], rows, library, still)
    assert centred.alignment_error_m[0] > 0.05
    assert centred.status[0] == AlignmentStatus.CONVERGED


def test_what_was_slid_has_the_cost_of_its_place_and_says_so():
    entities, graph, library = back_of_a_chair()
    scene = [entities], [graph], [rows_of([(1, 0, 0)], planes=0)], library
    (found,) = align_shortlists(*scene, SETTINGS)
    assert found.status[0] == AlignmentStatus.SLID and AlignmentStatus.SLID.usable
    pose = found.scale[0], found.yaw[0], *found.translation[0, :2]
    pair = as_pair(problem_of(*scene), 0)
    residuals = reference.residual_parts(pose, pair, weights_as_dict(WEIGHTS))
    np.testing.assert_allclose(found.cost[0], np.sum(residuals**2), rtol=1e-4)
    still = dataclasses.replace(SETTINGS, slide_hidden_m=float("inf"))
    (centred,) = align_shortlists(*scene, still)
    assert found.cost[0] > 1.1 * centred.cost[0], "the cost is not that of the minimum"


def test_what_was_not_solved_is_not_slid():
    entities, graph, library = back_of_a_chair()
    hasty = dataclasses.replace(SETTINGS, max_steps=1)
    scene = [entities], [graph], [rows_of([(1, 0, 0)], planes=0)], library
    (found,) = align_shortlists(*scene, hasty)
    assert found.status[0] == AlignmentStatus.NOT_CONVERGED
    assert not AlignmentStatus.NOT_CONVERGED.usable
    np.testing.assert_allclose(found.translation[0, :2], entities[1].box.center[:2], atol=1e-3)


def test_which_planes_support_follows_the_settings():
    """A table with a top that leans by 20 degrees carries at a_th = -0.9, not at -0.99."""
    entities, graph, library = table_scene()
    table = entities[1]
    normal = np.array(table.planes.normal)
    normal[0] = [np.sin(np.deg2rad(20)), 0, np.cos(np.deg2rad(20))]
    leaning = dataclasses.replace(table, planes=dataclasses.replace(table.planes, normal=normal))
    entities = scene_of(entities[0], leaning, entities[2])
    scene = [entities], [graph], [rows_of([(1, 0, 0), (1, 0, 8)])], library
    for up_cosine, carries in ((0.9, True), (0.99, False)):
        support = SupportSettings(up_cosine=up_cosine)
        supporting = problem_of(*scene, support).plane_supporting
        assert supporting[0].tolist() == [carries] + [False] * 7
        assert not supporting[1:].any(), "neither on its side, nor padding"
        heights = AlignmentSettings(
            **{f.name: 0.0 for f in dataclasses.fields(SETTINGS) if f.name.startswith("weight_")}
            | {"weight_support": 8.0, "prior_weight": 1e3}
        )
        (found,) = align_shortlists(*scene, heights, support)
        assert (found.cost[0] > 1e-4) == carries


# Builders


def test_an_empty_shortlist_gives_padding_alone():
    entities, graph, library = table_scene()
    rows = rows_of([(1, 0, 0)])
    empty = Shortlist(*(getattr(rows, f.name)[:0] for f in dataclasses.fields(rows)))
    for scenes in (([entities], [graph], [empty]), ([], [], [])):
        problem = problem_of(*scenes, library)
        solution = align(problem, WEIGHTS)
        assert len(problem.valid) and not problem.valid.any()
        assert all(np.all(np.isfinite(leaf)) for leaf in jax.tree.leaves(solution))
        assert np.all(solution.cost == 0)
        surfaces = surfaces_of(scenes[0], scenes[2], library)
        error = alignment_error(solution, surfaces)
        assert np.all(error == 0)


def test_built_problems_and_surfaces_give_what_shortlists_give():
    entities, graph, library = table_scene()
    scene = [entities], [graph], [rows_of([(1, 0, 0), (1, 1, 2), (2, 0, 0)])], library
    still = dataclasses.replace(SETTINGS, slide_hidden_m=float("inf"))
    (found,) = align_shortlists(*scene, still)
    solution = align(problem_of(*scene), WEIGHTS)
    surfaces = surfaces_of(scene[0], scene[2], library)
    assert surfaces.points.shape[0] == 2 and surfaces.triangles.shape[0] == 2
    error = alignment_error(solution, surfaces)
    np.testing.assert_array_equal(solution.T_world_cad[:3], found.T_world_cad)
    np.testing.assert_allclose(error[:3], found.alignment_error_m, atol=1e-6)
    assert np.all(error[3:] == 0)
    # The first point of each, and the last.
    few = surfaces_of(scene[0], scene[2], library, dataclasses.replace(SETTINGS, max_points=16))
    assert few.point_valid.sum(1).tolist() == [16, 16]


def test_a_shortlist_of_another_library_is_refused():
    entities, graph, library = table_scene()
    with pytest.raises(LibraryError, match="names model 7, but test library holds 2 models"):
        problem_of([entities], [graph], [rows_of([(1, 7, 0)])], library)
    with pytest.raises(LibraryError, match="from"):
        surfaces_of([entities], [rows_of([(1, 2, 0)])], library)


def test_an_unknown_normal_residual_is_refused():
    with pytest.raises(SettingError, match="use one of: vector, paper"):
        with_overrides(Settings(), ["alignment.normal_residual=papper"])


def test_the_cost_at_a_solution_is_its_cost():
    problem = pairs_of(9, LANES, copies=False)
    solution = align(problem, WEIGHTS)
    pose = solution.scale, solution.yaw, solution.translation
    np.testing.assert_allclose(
        cost_at(problem, WEIGHTS, *pose), solution.cost, rtol=1e-3, atol=1e-6
    )


def test_numbers_that_only_scale_compile_nothing():
    problem = pairs_of(9, LANES, copies=False)
    align(problem, WEIGHTS)
    before = solve._align._cache_size()
    for change in ({"tolerance": 1e-4}, {"scale_min": 0.7}, {"scale_max": 3.0}):
        align(problem, WEIGHTS, dataclasses.replace(SETTINGS, **change))
    align(problem, dataclasses.replace(WEIGHTS, offset=np.asarray(2 * WEIGHTS.offset)))
    assert solve._align._cache_size() == before > 0
