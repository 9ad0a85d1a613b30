"""Derivatives through the alignment: against finite differences, in every mode, beside padding."""

from __future__ import annotations

import dataclasses

import equinox as eqx
import jax
import jax.numpy as jnp
import numpy as np

from isr_jax.alignment import (
    AlignmentProblem,
    AlignmentWeights,
    align,
    alignment_error,
    problem_of,
    surfaces_of,
)
from isr_jax.geometry import make_T, rot_z
from isr_jax.types import AlignmentStatus

from .alignment_pairs import (
    LANES,
    SETTINGS,
    WEIGHTS,
    cost_and_gradient,
    one_pair,
    one_pose,
    pairs_of,
    rows_of,
    table_scene,
)
from .builders import box_mesh

EXACT = dataclasses.replace(SETTINGS, tolerance=1e-13, max_steps=256)
PATIENT = dataclasses.replace(SETTINGS, max_steps=256)
"""At a bound the sine is flat, and steps are many."""
STEP = 2e-4
"""Accepting steps by their cost finds the unknowns to 1e-8, the root of float64's precision; over
the step that is 1e-4. A longer step crosses kinks of hinges."""
CLOSE = {"rtol": 1e-3, "atol": 2e-4}

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


def doubled(tree):
    """The same numbers in float64."""
    return jax.tree.map(
        lambda leaf: leaf.astype(np.float64) if leaf.dtype == np.float32 else leaf, tree
    )


def slope_along(function, at, direction):
    """Derivative of ``function`` along a direction, by central differences of fourth order."""

    def moved(step):
        return float(function(jax.tree.map(lambda v, d: v + step * d, at, direction)))

    wide = moved(2 * STEP) - moved(-2 * STEP)
    return (8 * (moved(STEP) - moved(-STEP)) - wide) / (12 * STEP)


def random_like(rng, tree):
    return jax.tree.map(lambda leaf: rng.normal(size=np.shape(leaf)), tree)


def inner(a, b) -> float:
    return float(sum(np.sum(x * y) for x, y in zip(jax.tree.leaves(a), jax.tree.leaves(b))))


def poses_and_costs(problem: AlignmentProblem, weights: AlignmentWeights):
    """A number that every field of the solution takes part in."""
    solution = align(problem, weights, EXACT)
    pose = jnp.sum(jnp.sin(solution.T_world_cad) * jnp.arange(16.0).reshape(4, 4))
    return pose + jnp.sum(solution.scale) + jnp.sum(solution.cost)


@eqx.filter_jit
def value_and_slopes(problem, weights):
    """Of `poses_and_costs` in all that is not a mask, in reverse mode."""
    return eqx.filter_value_and_grad(lambda both: poses_and_costs(*both))((problem, weights))


def exact_pairs():
    return pairs_of(8, LANES, copies=False, dtype=np.float64), doubled(WEIGHTS)


def test_derivatives_match_finite_differences():
    with jax.enable_x64(True):
        both = exact_pairs()
        rng = np.random.default_rng(0)
        _, slopes = value_and_slopes(*both)
        for name, where in DERIVED.items():
            direction = random_like(rng, where(*both))

            def of(values, where=where):
                return value_and_slopes(*eqx.tree_at(lambda b: where(*b), both, values))[0]

            reverse = inner(where(*slopes), direction)
            difference = slope_along(of, where(*both), direction)
            np.testing.assert_allclose(reverse, difference, **CLOSE, err_msg=name)


def assert_same(tree, other):
    for a, b in zip(jax.tree.leaves(tree), jax.tree.leaves(other), strict=True):
        np.testing.assert_allclose(a, b, rtol=1e-6, atol=1e-8)


def test_every_transformation_gives_the_same_derivatives():
    """`jax.grad` in boxes and planes, `jax.jacfwd`, and `jax.vmap` of it, in weights."""
    with jax.enable_x64(True):
        problem, weights = exact_pairs()
        _, (whole, by_weight) = value_and_slopes(problem, weights)
        assert whole.valid is None and whole.plane_valid is None

        @jax.jit
        @jax.grad
        def by_geometry(geometry):
            box, offset = geometry
            moved = dataclasses.replace(problem, box=box, entity_offset=offset)
            return poses_and_costs(moved, weights)

        geometry = problem.box, problem.entity_offset
        assert_same(by_geometry(geometry), (whole.box, whole.entity_offset))
        many = jax.tree.map(lambda w: w * np.array([0.5, 1.0]), weights)
        forward = jax.jit(jax.vmap(jax.jacfwd(lambda w: poses_and_costs(problem, w))))(many)
        assert_same(jax.tree.map(lambda leaf: leaf[1], forward), by_weight)
        _, (_, halved) = value_and_slopes(problem, jax.tree.map(lambda leaf: leaf[0], many))
        assert_same(jax.tree.map(lambda leaf: leaf[0], forward), halved)


def lanes_of(problem, rows) -> AlignmentProblem:
    """As many lanes as before: those of ``rows``, and padding in place of the others."""
    keep = np.isin(np.arange(LANES), rows)

    def masked(leaf):
        return np.where(np.reshape(keep, (-1,) + (1,) * (leaf.ndim - 1)), leaf, np.zeros_like(leaf))

    return jax.tree.map(masked, problem)


def test_padding_changes_nothing_and_has_no_derivatives():
    problem, half = pairs_of(8, LANES, copies=False), LANES // 2
    whole = cost_and_gradient(problem, WEIGHTS)
    parts = [
        cost_and_gradient(lanes_of(problem, rows), WEIGHTS)
        for rows in np.arange(LANES).reshape(2, half)
    ]
    (total, solution), (slopes, by_weight) = whole
    np.testing.assert_allclose(sum(part[0][0] for part in parts), total, rtol=1e-5)
    first, (first_slopes, _) = parts[0][0][1], parts[0][1]
    np.testing.assert_array_equal(first.cost[half:], 0)
    np.testing.assert_allclose(first.scale[:half], solution.scale[:half], rtol=1e-5)
    for a, b in zip(jax.tree.leaves(slopes), jax.tree.leaves(first_slopes), strict=True):
        np.testing.assert_allclose(b[:half], a[:half], rtol=1e-3, atol=1e-4)
        np.testing.assert_array_equal(b[half:], 0)
    summed = jax.tree.map(lambda a, b: a + b, *(part[1][1] for part in parts))
    for a, b in zip(jax.tree.leaves(by_weight), jax.tree.leaves(summed), strict=True):
        np.testing.assert_allclose(b, a, rtol=1e-4, atol=1e-4)


def test_lanes_without_a_problem_do_not_feel_the_weights():
    """Each derivative is exactly 0: with a million lanes of padding rounding would add up."""
    nothing = lanes_of(pairs_of(8, LANES, copies=False), [])
    (_, solution), (_, by_weight) = cost_and_gradient(nothing, WEIGHTS)
    assert np.all(solution.cost == 0)
    for slope in jax.tree.leaves(by_weight):
        assert slope == 0


def test_at_a_bound_the_scale_has_no_derivative():
    problem = pairs_of(4, LANES, copies=True)
    grown = dataclasses.replace(
        problem, model_size=3 * problem.model_size, model_offset=3 * problem.model_offset
    )

    @jax.jit
    def scale_and_slopes(weights):
        def scale(weights):
            solution = align(grown, weights, PATIENT)
            return solution.scale.sum(), solution.status

        return jax.value_and_grad(scale, has_aux=True)(weights)

    (_, status), slopes = scale_and_slopes(WEIGHTS)
    assert np.all(status == AlignmentStatus.AT_BOUND)
    for slope in jax.tree.leaves(slopes):
        np.testing.assert_allclose(slope, 0.0, atol=1e-4)


# The alignment error


def test_alignment_error_derivative_matches_finite_differences():
    with jax.enable_x64(True):
        mesh = box_mesh((1, 0.8, 0.6), spacing_m=0.3)
        points = np.random.default_rng(5).normal(0, 0.7, (30, 3))
        pair = one_pair(points, mesh.vertices[mesh.faces].astype(np.float64))

        def error(step):
            T = make_T(rot_z(0.3 + step), jnp.array([0.1, 0.2, 0.3]) * (1 + step))
            return alignment_error(one_pose(T, 1.1 + step), pair)[0]

        slope = jax.grad(error)(jnp.asarray(0.0))
        difference = (error(jnp.asarray(1e-6)) - error(jnp.asarray(-1e-6))) / 2e-6
        np.testing.assert_allclose(slope, difference, rtol=1e-6)


def test_the_alignment_error_is_differentiated_through_the_alignment():
    entities, graph, library = table_scene()
    shortlist = rows_of([(1, 0, 0), (1, 1, 2), (2, 0, 0)])
    with jax.enable_x64(True):
        problem = doubled(problem_of([entities], [graph], [shortlist], library))
        surfaces = doubled(surfaces_of([entities], [shortlist], library))
        weights, rng = doubled(WEIGHTS), np.random.default_rng(1)

        @eqx.filter_jit
        def error_and_slopes(weights, problem):
            def error(both):
                solution = align(both[1], both[0], EXACT)
                return alignment_error(solution, surfaces).sum()

            return eqx.filter_value_and_grad(error)((weights, problem))

        _, (by_weight, by_problem) = error_and_slopes(weights, problem)
        direction = random_like(rng, weights)
        difference = slope_along(lambda w: error_and_slopes(w, problem)[0], weights, direction)
        np.testing.assert_allclose(inner(by_weight, direction), difference, **CLOSE)
        assert abs(difference) > 1e-3
        for leaf in jax.tree.leaves(by_problem):
            assert np.all(np.isfinite(leaf))
            np.testing.assert_array_equal(leaf[3:], 0)
