"""Convex parts and placed solids: ways out, contact, what moves with what."""

from __future__ import annotations

import numpy as np
import pytest

from isr_jax.geometry import (
    box_part,
    convex_part,
    penetration,
    shifted_part,
    sideways_exit,
    vertical_gap,
)
from isr_jax.geometry.placed_solids import CONTACT_LIFT_M, PlacedSolid, deepest_overlap
from isr_jax.geometry.standing import StandingThings, SupportTree

EXACT = 1e-9  # float64 of boxes with short decimals


def cube(x=0.0, y=0.0, z=0.0, yaw=0.0, size=(1.0, 1.0, 1.0)):
    c, s = np.cos(yaw), np.sin(yaw)
    T = np.array([[c, -s, 0, x], [s, c, 0, y], [0, 0, 1, z], [0, 0, 0, 1]], float)
    return box_part(np.array(size), T)


def solid(*parts, swelling_m=0.0):
    return PlacedSolid(parts, swelling_m)


def random_part(rng):
    return convex_part(rng.normal(0, 0.3, (12, 3)) + rng.normal(0, 0.2, 3))


def test_depth_of_boxes_is_that_of_the_shallowest_axis():
    assert abs(penetration(cube(), cube(0.9, 0.3, 0.2))[0] - 0.1) < EXACT
    assert penetration(cube(), cube(1.01))[0] == 0.0
    # turned by 45 degrees its corner reaches sqrt(2)/2 along x
    turned = cube(1.1, yaw=np.pi / 4)
    assert abs(penetration(cube(), turned)[0] - (0.5 + np.sqrt(0.5) - 1.1)) < EXACT


def test_depth_sees_a_box_inside_another():
    assert abs(penetration(cube(size=(0.1, 0.1, 0.1)), cube())[0] - 0.55) < EXACT


def test_vertical_gap_tells_drop_lift_and_beside():
    assert abs(vertical_gap(cube(z=1.25, x=0.3), cube()) - 0.25) < EXACT
    assert abs(vertical_gap(cube(z=0.95, x=0.3), cube()) + 0.05) < EXACT
    assert vertical_gap(cube(z=3.0, x=1.0001), cube()) == np.inf
    assert vertical_gap(cube(z=-1.5), cube()) == np.inf


@pytest.mark.parametrize("seed", range(12))
def test_after_the_vertical_move_parts_touch(seed):
    rng = np.random.default_rng(seed)
    a, b = random_part(rng), random_part(rng)
    gap = vertical_gap(a, b)
    while not np.isfinite(gap):
        a, b = random_part(rng), random_part(rng)
        gap = vertical_gap(a, b)
    for slack, met in ((-1e-6, True), (1e-6, False)):
        moved = shifted_part(a, np.array([0.0, 0.0, -gap + slack]))
        assert (penetration(moved, b)[0] > 0) == met


@pytest.mark.parametrize("seed", range(12))
def test_the_sideways_exit_is_level_and_the_shortest_that_frees(seed):
    rng = np.random.default_rng(seed)
    a, b = random_part(rng), random_part(rng)
    while penetration(a, b)[0] == 0:
        a, b = random_part(rng), random_part(rng)
    length, direction = sideways_exit(a, b)
    assert direction[2] == 0 and abs(np.linalg.norm(direction) - 1) < EXACT
    assert penetration(shifted_part(a, direction * (length + 1e-7)), b)[0] == 0.0
    for angle in np.arange(0, 2 * np.pi, 0.1):
        step = (length - 1e-6) * np.array([np.cos(angle), np.sin(angle), 0.0])
        assert penetration(shifted_part(a, step), b)[0] > 0


@pytest.mark.parametrize("seed", range(8))
def test_the_deepest_overlap_is_that_of_all_pairs_wherever_the_solids_were_moved(seed):
    rng = np.random.default_rng(seed)
    a, b = (solid(*(random_part(rng) for _ in range(5))) for _ in range(2))
    a = a.moved(rng.normal(0, 0.1, 3)).moved(rng.normal(0, 0.1, 3))
    depths = [penetration(p, q)[0] for p in a.parts for q in b.parts]
    found = deepest_overlap(a, b)
    assert (found is None) == (max(depths) == 0)
    if found is not None:
        assert abs(found.depth_m - max(depths)) < EXACT
        assert deepest_overlap(a, b, least_m=max(depths) + 1e-9) is None
    np.testing.assert_allclose(a.low, np.min([p.low for p in a.parts], 0))
    np.testing.assert_allclose(a.high, np.max([p.high for p in a.parts], 0))


SEAT, BACK = cube(z=0.42, size=(0.44, 0.44, 0.04)), cube(y=0.2, z=0.66, size=(0.44, 0.04, 0.44))


def bag(y, z):
    return solid(cube(y=y, z=z, size=(0.3, 0.2, 0.3)))


def test_of_what_carries_a_thing_the_seat_is_contact_and_the_back_is_not():
    chair = solid(SEAT, BACK)
    sunk = bag(-0.1, 0.44 + 0.15 - 0.02)
    assert deepest_overlap(sunk, chair).depth_m == pytest.approx(0.02)
    assert deepest_overlap(sunk, chair, carried=True) is None
    deeper = bag(-0.1, 0.44 + 0.15 - 1.1 * CONTACT_LIFT_M)
    assert deepest_overlap(deeper, chair, carried=True).depth_m == pytest.approx(0.033)
    against = bag(0.11, 0.44 + 0.15 - 0.02)  # 3 cm into the back
    found = deepest_overlap(against, chair, carried=True)
    assert found.other is BACK and found.depth_m == pytest.approx(0.03)
    length, direction = found.way_out()
    assert length == pytest.approx(0.03) and direction[1] == pytest.approx(-1)


def test_contact_with_hulls_that_may_reach_too_far_allows_for_that():
    deeper = bag(-0.1, 0.44 + 0.15 - 1.1 * CONTACT_LIFT_M)
    assert deepest_overlap(deeper, solid(SEAT, swelling_m=0.01), carried=True) is None


def test_a_move_takes_along_what_stands_on_a_thing_and_can_be_undone():
    # 0 floor, 1 table, 2 cup on it, 3 spoon in the cup, 4 lamp screwed to the table, 5 beside
    tree = SupportTree(np.array([-1, 0, 1, 2, 1, 0]), fixed={4})
    assert tree.subtree(1) == [1, 2, 3] and tree.carriers(3) == [2, 1, 0]
    assert tree.top_down([3, 5, 2, 1]) == [1, 5, 2, 3]
    assert tree.stands_on(2, 1) and not tree.stands_on(3, 1)
    scene = StandingThings(tree, {i: solid(cube(x=3.0 * i)) for i in range(6)})
    places = scene.places()
    scene.move(1, np.array([0.1, 0, 0]))
    scene.move(2, np.array([0, 0.2, 0]))
    assert [s.tolist() for s in scene.shift_m.values()] == [
        [0, 0, 0],
        [0.1, 0, 0],
        [0.1, 0.2, 0],
        [0.1, 0.2, 0],
        [0, 0, 0],
        [0, 0, 0],
    ]
    np.testing.assert_allclose(scene.things[3].low, [8.6, -0.3, -0.5])
    scene.put_back(places)
    assert not any(np.any(step) for step in scene.shift_m.values())
    np.testing.assert_allclose(scene.things[3].low, [8.5, -0.5, -0.5])


def test_no_step_out_leads_farther_than_is_allowed():
    tree = SupportTree(np.array([-1, -1]))
    scene = StandingThings(tree, {0: solid(cube()), 1: solid(cube(x=0.9))})
    overlap = deepest_overlap(scene.things[1], scene.things[0])
    step = scene.step_out(1, overlap, gap_m=0.01, farthest_m=0.12)
    np.testing.assert_allclose(step, [0.11, 0, 0], atol=EXACT)
    scene.move(1, np.array([0.05, 0, 0]))
    overlap = deepest_overlap(scene.things[1], scene.things[0])
    assert scene.step_out(1, overlap, gap_m=0.01, farthest_m=0.1) is None
