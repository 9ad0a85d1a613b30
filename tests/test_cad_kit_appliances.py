"""Appliances, sanitary ware and electronics of the kit are sound; one of each maker.

``-m slow`` takes every model.
"""

from __future__ import annotations

import collections

import numpy as np
import pytest

from isr_jax.cad.checking.model import check_model
from isr_jax.cad.kit import KIT, fit_cad, make
from isr_jax.cad.kit.appliances.catalogue import ROWS
from isr_jax.cad.kit.appliances.computers import laptop
from isr_jax.cad.kit.appliances.toilets import toilet
from isr_jax.classes import class_named
from isr_jax.errors import SettingError
from isr_jax.library import CadModel
from isr_jax.robot_model import link_transforms

from . import kit_soundness as sound

MASS_RANGE_KG = {
    "fridge": (15, 140),
    "microwave": (9, 22),
    "oven": (30, 85),
    "dishwasher": (30, 52),
    "washing_machine": (40, 82),
    "sink": (1.4, 70),
    "toilet": (12, 40),
    "bathtub": (20, 42),
    "monitor": (3, 25),
    "laptop": (0.8, 3),
    "keyboard": (0.15, 1.4),
    "kettle": (0.6, 1.4),
}
"""What such things weigh in shops: a vessel of 0.4 m and a vanity with its cabinet are sinks."""
TABLE_TOP_OVEN_KG = (3, 14)
HANDLE_M = 0.052
CLASSES = sorted(MASS_RANGE_KG)
GRAVITY_M_S2 = 9.81


def _ids(every: bool) -> list[str]:
    rows = [(name, row) for name, rows in ROWS.items() for row in rows]
    first = {
        (name, row.maker, row.options.get("kind"), row.options.get("closed")): f"{name}/{row.name}"
        for name, row in reversed(rows)
    }
    return [f"{name}/{row.name}" for name, row in rows] if every else sorted(first.values())


@pytest.fixture(
    scope="module",
    params=[pytest.param(False, id="one of each"), pytest.param(True, marks=pytest.mark.slow)],
)
def models(request) -> list[CadModel]:
    return [make(cad_id) for cad_id in _ids(request.param)]


def test_there_are_many_of_each_class():
    count = collections.Counter({name: len(rows) for name, rows in ROWS.items()})
    assert set(count) == set(CLASSES) and min(count.values()) >= 5 and count.total() >= 95
    assert all(f"{name}/{row.name}" in KIT for name, rows in ROWS.items() for row in rows)


def test_solids_are_convex_closed_and_apart(models):
    for model in models:
        sound.assert_hulls_are_closed_convex_and_small(model)
        sound.assert_visuals_are_the_skin_of_the_hulls(model)
        sound.assert_parts_do_not_overlap(model)


def test_box_is_that_of_the_row_without_handles(models):
    for model in models:
        np.testing.assert_allclose(model.size, KIT[model.id].size, atol=1e-4)
        reach = dict.fromkeys((1, 5), HANDLE_M) if model.articulated else {}
        sound.assert_box_is_that_of_the_body(model, reach)


def test_masses_are_those_of_real_things(models):
    for model in models:
        low, high = MASS_RANGE_KG[model.class_name]
        if model.class_name == "oven" and model.mount == "surface":
            low, high = TABLE_TOP_OVEN_KG
        if model.mount == "surface" and model.class_name == "dishwasher":
            low = 20
        assert low < model.robot.mass_kg < high, (model.id, model.robot.mass_kg)
        for link in model.robot.links:
            moments = np.linalg.eigvalsh(link.inertia)
            assert moments[0] > 0 and moments[0] + moments[1] > moments[2], (model.id, link.name)


def test_what_stands_stands_over_its_feet(models):
    for model in models:
        if model.mount in ("floor", "surface"):
            sound.assert_stands_over_its_feet(model)


def test_planes_lie_on_free_surfaces(models):
    rng = np.random.default_rng(0)
    for model in models:
        sound.assert_planes_lie_on_free_surfaces(model, rng)


def test_symmetry_is_the_largest_true_one(models):
    for model in models:
        sound.assert_symmetry_is_the_largest_true_one(model)


def test_joints_open_towards_a_hand(models):
    for model in models:
        if class_named(model.class_name).articulated:
            assert model.articulated, model.id
        sound.assert_opens_towards_a_hand(model)
        assert not any(handle.estimated for handle in model.handles), model.id


def test_moving_parts_keep_clear_of_everything(models):
    rng = np.random.default_rng(0)
    for model in models:
        if model.class_name == "toilet":  # with its seat up, the lid has no room left
            poses = [
                {j.name: j.upper * q}
                for j in model.robot.moving_joints
                for q in (0.0, 0.03, 0.15, 0.5, 0.8, 1.0)
            ]
            assert min(sound.least_distance(model, q) for q in poses) > sound.CLEARANCE_M, model.id
        elif model.articulated:
            sound.assert_moving_parts_keep_clear(model, rng)


def test_the_check_of_libraries_finds_no_fault(models):
    """It stands in its mount, and every joint travels under a hand, with base fixed and free."""
    every = len(models) == len(_ids(True))
    chosen = models if every else {m.class_name: m for m in models}.values()
    for model in chosen:
        found = check_model(model).faults
        assert not found, (model.id, found)


def test_doors_that_open_down_are_kept_closed_and_open_by_their_weight(models):
    """The moment about the hinge of the door's weight, closed and open."""
    seen = 0
    for model in (m for m in models if m.class_name in ("oven", "dishwasher")):
        for joint in model.robot.moving_joints:
            if not joint.child.startswith("door"):
                continue
            com = model.robot.link(joint.child).com
            assert com[1] > 0 and com[2] > 0, model.id  # behind the axis: it cannot fall open
            T = link_transforms(model.robot, {joint.name: joint.upper})[joint.child]
            assert (T[:3, :3] @ com)[1] < -0.05, model.id
            seen += 1
    assert seen >= 4


def test_lids_of_laptops_are_held_against_their_weight(models):
    for model in (m for m in models if m.class_name == "laptop"):
        (joint,) = model.robot.moving_joints
        lid = model.robot.link(joint.child)
        worst = lid.mass_kg * GRAVITY_M_S2 * np.linalg.norm(lid.com)
        assert worst < joint.friction < 2 * worst, model.id


@pytest.mark.parametrize(
    "cad_id",
    [
        "bathtub/skirt_170",
        "bathtub/oval_170",
        "sink/vessel_round_40",
        "sink/vanity_60",
        "kettle/steel_17",
        "kettle/stove_steel_25",
        "sink/utility_58",
        "toilet/close_coupled_66",
    ],
)
def test_what_holds_things_is_hollow(cad_id):
    """Upright lines near the middle of the hollow meet a floor, and nothing above it."""
    model = make(cad_id)
    lids = {"lid", "seat"} | {link.name for link in model.robot.links if "lever" in link.name}
    hulls = [
        h
        for link in model.robot.links
        if link.name not in lids
        for h in sound.hulls_at_rest(model, link.name)
    ]
    middle = {"sink/utility_58": (0.0, -0.04), "toilet/close_coupled_66": (0.0, -0.14)}
    z = np.linspace(-model.size[2] / 2, model.size[2] / 2, 241)
    x, y = middle.get(cad_id, (0.0, 0.0))
    inside = sound.inside_any(np.column_stack([np.full(241, x), np.full(241, y), z]), hulls)
    floor = np.flatnonzero(inside)
    if cad_id.startswith("kettle/stove"):
        floor = floor[floor < 150]  # the handle is bent over it
    hollow = model.size[2] * (240 - floor.max()) / 240
    assert len(floor) and hollow > 0.09, (hollow, floor)


def test_drums_are_hollow_and_seen_through_the_porthole():
    model = make("washing_machine/white_60")
    poses = link_transforms(model.robot)
    start = poses["drum"][:3, 3]
    line = start + np.linspace(0, 1, 50)[:, None] * [0.0, 0.25, 0.0] + [0.03, 0.0, 0.02]
    drum, base = (sound.hulls_at_rest(model, name) for name in ("drum", "base"))
    assert not sound.inside_any(line, drum).any()
    outward = start - np.linspace(0, 0.25, 50)[:, None] * [0.0, 1.0, 0.0]
    assert not sound.inside_any(outward, base).any()


@pytest.mark.parametrize("cad_id", _ids(False))
def test_models_are_made_at_other_sizes(cad_id):
    """Boxes 0.6 to 1.6 times as large come out as asked, their parts still apart."""
    rng = np.random.default_rng(len(cad_id))
    size = np.round(np.array(KIT[cad_id].size) * rng.uniform(0.6, 1.6, 3), 3)
    model = fit_cad(cad_id, size.tolist())
    np.testing.assert_allclose(model.size, size, atol=1.01e-4)
    sound.assert_parts_do_not_overlap(model)


@pytest.mark.parametrize("detail", ["low", "high"])
def test_other_levels_of_detail_are_sound(detail):
    for cad_id in ("toilet/wall_53", "kettle/steel_17", "oven/hot_plate_50", "bathtub/oval_170"):
        model = make(cad_id, detail)
        np.testing.assert_allclose(model.size, KIT[cad_id].size, atol=1e-4)
        sound.assert_hulls_are_closed_convex_and_small(model)
        sound.assert_parts_do_not_overlap(model)


def test_an_open_laptop_fills_its_box_at_any_proportion():
    rng = np.random.default_rng(0)
    for depth, height in rng.uniform((0.16, 0.13), (0.4, 0.3), (40, 2)):
        design = laptop(0.33, depth, height)
        np.testing.assert_allclose(design.size, (0.33, depth, height), atol=1e-5)


def test_sizes_that_make_no_object_are_refused():
    with pytest.raises(SettingError, match="4 times"):
        laptop(0.33, 0.9, 0.1)
    with pytest.raises(SettingError, match="reach"):
        toilet(0.38, 0.66, 0.3)
