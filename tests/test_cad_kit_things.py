"""Small things, lamps, plants, boxes, bags, doors and windows of the kit are sound.

One model of each maker; ``-m slow`` takes every model.
"""

from __future__ import annotations

import functools
from collections.abc import Callable

import mujoco
import numpy as np
import pytest

from isr_jax.cad.checking.model import check_model
from isr_jax.cad.checking.settings import CheckSettings
from isr_jax.cad.checking.static import hull_faults
from isr_jax.cad.kit.rows import Row
from isr_jax.cad.kit.shapes.strips import raised, spike, strip
from isr_jax.cad.kit.shapes.turned import inner_radii, shell, stack
from isr_jax.cad.kit.things.bins import swing_bin
from isr_jax.cad.kit.things.boxes import carton, open_carton, storage_box
from isr_jax.cad.kit.things.catalogue import ROWS
from isr_jax.cad.kit.things.desk_lamps import arm_lamp
from isr_jax.cad.kit.things.doors import door, double_door
from isr_jax.cad.kit.things.vessels import bottle, bowl, cup
from isr_jax.cad.kit.things.windows import casement_window
from isr_jax.errors import SettingError
from isr_jax.library import CadModel
from isr_jax.robot_model import link_transforms

from . import kit_soundness as sound

MASS_RANGE_KG = {
    "cup": (0.04, 0.8),
    "bowl": (0.1, 1.0),
    "bottle": (0.3, 2.0),
    "book": (0.1, 2.5),
    "bin": (0.5, 4.5),
    "box": (0.08, 16),
    "bag": (0.02, 7),
    "lamp": (0.5, 9),
    "plant": (0.5, 24),
    "door": (20, 190),
    "window": (10, 90),
}
"""What such things weigh in shops; patio doors and triple windows are heavy with glass."""
BOX_TOLERANCE_M = 5e-5
"""Half of what a fitted model may be off its box."""
SCALES = ((0.6, 0.6, 0.6), (1.6, 1.6, 1.6), (0.6, 1.6, 1.0), (1.6, 0.6, 1.0), (1.0, 1.0, 0.6))


@functools.cache
def model_of(class_name: str, name: str) -> CadModel:
    return row_of(class_name, name).design().build(name)


def row_of(class_name: str, name: str) -> Row:
    return next(row for row in ROWS[class_name] if row.name == name)


def one_of_each_maker() -> list[tuple[str, str]]:
    first = {(c, row.maker): (c, row.name) for c, rows in ROWS.items() for row in rows[::-1]}
    return sorted(first.values())


EVERY = [(c, row.name) for c, rows in ROWS.items() for row in rows]
SAMPLE = one_of_each_maker()
REST = sorted(set(EVERY) - set(SAMPLE))


@pytest.fixture(
    params=[
        *(pytest.param(key, id="/".join(key)) for key in SAMPLE),
        *(pytest.param(key, id="/".join(key), marks=pytest.mark.slow) for key in REST),
    ]
)
def model(request) -> CadModel:
    return model_of(*request.param)


def test_there_are_many_of_each_class():
    assert set(ROWS) == set(MASS_RANGE_KG)
    assert all(len({row.name for row in rows}) == len(rows) >= 6 for rows in ROWS.values())
    assert len(EVERY) >= 85


def test_parts_are_sound(model):
    sound.assert_hulls_are_closed_convex_and_small(model)
    sound.assert_visuals_are_the_skin_of_the_hulls(model)
    sound.assert_parts_do_not_overlap(model)
    sound.assert_symmetry_is_the_largest_true_one(model)
    sound.assert_planes_lie_on_free_surfaces(model, np.random.default_rng(0))


def test_box_is_the_asked_one(model):
    row = row_of(*model.id.split("/"))
    np.testing.assert_allclose(model.size, row.size, atol=BOX_TOLERANCE_M)
    front, side = (0.066, 0.05) if model.articulated else (3e-6, 3e-6)
    out = {1: front, 3: side if model.articulated else 3e-6}
    if model.class_name == "cup":
        out = {3: 0.05}  # its handle
    elif model.class_name == "door":
        out = {1: 0.062, 4: 0.1}  # levers before and behind the leaf
    elif model.class_name == "bag":
        out = {5: 0.04}  # a suitcase's carrying handle
    sound.assert_box_is_that_of_the_body(model, out)


def test_masses_are_those_of_real_things(model):
    low, high = MASS_RANGE_KG[model.class_name]
    assert low < model.robot.mass_kg < high


@pytest.mark.parametrize(
    ("key", "low", "high"),
    [
        (("door", "interior_86"), 15, 30),
        (("door", "panelled_oak"), 15, 30),
        (("lamp", "table_urn"), 1, 4),
        (("plant", "sill_small"), 0.5, 2),
        (("plant", "rubber_tree"), 8, 20),
        (("bag", "suitcase_cabin"), 2, 3.5),
        (("box", "carton_40"), 0.2, 1),
        (("bin", "square_30"), 0.5, 3),
    ],
)
def test_common_things_weigh_what_they_do_in_shops(key, low, high):
    """Of a door its leaf, which is what a hand moves."""
    links = model_of(*key).robot.links
    mass = sum(k.mass_kg for k in links if key[0] != "door" or k.name == "leaf")
    assert low < mass < high


def test_things_stand_over_their_feet(model):
    if model.mount in ("floor", "surface"):
        sound.assert_stands_over_its_feet(model)


def test_moving_parts_keep_clear_and_have_handles(model):
    sound.assert_opens_towards_a_hand(model)
    if model.articulated:
        sound.assert_moving_parts_keep_clear(model, np.random.default_rng(0))


def test_it_stands_and_opens_in_mujoco(model):
    """In its mount it stays within 1 mm for 5 s; a hand opens each joint, base held and free."""
    checked = check_model(model)
    assert not checked.faults and not checked.skipped, checked.faults


@pytest.mark.parametrize("key", SAMPLE, ids="/".join)
def test_designs_take_other_sizes(key):
    row = row_of(*key)
    for scale in SCALES:
        size = tuple(round(a * b, 4) for a, b in zip(row.size, scale))
        np.testing.assert_allclose(row.design(size).size, size, atol=BOX_TOLERANCE_M)


@pytest.mark.slow
@pytest.mark.parametrize("scale", SCALES)
@pytest.mark.parametrize("key", EVERY, ids="/".join)
def test_models_of_other_sizes_are_sound(key, scale):
    row = row_of(*key)
    size = tuple(round(a * b, 4) for a, b in zip(row.size, scale))
    fitted = row.design(size).build(row.name)
    assert not hull_faults(fitted, CheckSettings())
    sound.assert_parts_do_not_overlap(fitted)
    if fitted.articulated:
        sound.assert_moving_parts_keep_clear(fitted, np.random.default_rng(0))


REFUSED: list[tuple[str, Callable]] = [
    ("stop", lambda: door(0.9, 0.045, 2.0)),
    ("neck", lambda: bottle(0.07, 0.07, 0.06, cap=0.03)),
    ("label", lambda: bottle(0.07, 0.07, 0.3, label=(0.3, 0.9))),
    ("sashes", lambda: casement_window(0.4, 0.07, 1.0, sashes=("left", "right", "left"))),
    ("wall", lambda: cup(0.006, 0.006, 0.05)),
    ("walls", lambda: bowl(0.01, 0.01, 0.05)),
    ("arms", lambda: arm_lamp(0.2, 0.5, 0.15)),
    ("reach", lambda: arm_lamp(0.2, 5.0, 0.5)),
    ("lid", lambda: storage_box(0.3, 0.2, 0.02)),
]


@pytest.mark.parametrize("make", [p[1] for p in REFUSED], ids=[p[0] for p in REFUSED])
def test_sizes_that_make_no_object_are_refused(make):
    with pytest.raises(SettingError) as refusal:
        make()
    assert refusal.value.hint


def test_vessels_hold_what_they_should():
    """A ball dropped into a bowl, a cup, a bin and an open carton stays in it."""
    for key in (("bowl", "cereal_15"), ("cup", "mug"), ("bin", "round_28"), ("box", "euro_40")):
        held = model_of(*key)
        spec = mujoco.MjSpec()
        spec.option.timestep = 0.0005  # walls are 3 mm thin
        for i, hull in enumerate(held.robot.links[0].hulls):
            vertices, faces = hull.vertices.ravel().tolist(), hull.faces.ravel().tolist()
            spec.add_mesh(name=f"hull_{i}", uservert=vertices, userface=faces)
            kind = mujoco.mjtGeom.mjGEOM_MESH
            spec.worldbody.add_geom(type=kind, meshname=f"hull_{i}")
        ball = spec.worldbody.add_body(name="ball", pos=[0.004, 0.003, held.size[2] / 2 + 0.02])
        ball.add_freejoint()
        sphere = ball.add_geom(type=mujoco.mjtGeom.mjGEOM_SPHERE, size=[0.012, 0, 0], mass=0.01)
        sphere.solref, sphere.priority = (0.002, 1.0), 1
        compiled = spec.compile()
        data = mujoco.MjData(compiled)
        mujoco.mj_step(compiled, data, 2000)
        place = data.body("ball").xpos
        assert -held.size[2] / 2 < place[2] < held.size[2] / 2 - 0.012, (held.id, place)
        assert np.all(np.abs(place[:2]) < held.size[:2] / 2), (held.id, place)


def test_flaps_of_a_carton_open_outwards_and_lay_bare_its_inside():
    model = carton(0.4, 0.3, 0.3).build("closed")
    poses = link_transforms(model.robot, {"flap_1_joint": 3.6, "flap_2_joint": 3.6})
    for name, side in (("flap_1", -1), ("flap_2", 1)):
        com = poses[name] @ np.append(model.robot.link(name).com, 1)
        assert side * com[1] > model.size[1] / 2 and com[2] < model.size[2] / 2


def test_an_open_cartons_box_holds_its_flaps():
    model = open_carton(0.6, 0.5, 0.3).build("open")
    base = np.concatenate([h.vertices for h in model.robot.links[0].hulls])
    assert np.ptp(base[:, 0]) < 0.4 and len(model.moving_joints) == 4
    closed = link_transforms(model.robot, {f"flap_{k}_joint": 1.9 for k in range(1, 5)})
    tops = [
        (closed[f"flap_{k}"] @ np.append(model.robot.link(f"flap_{k}").com, 1))[2] for k in (1, 3)
    ]
    assert min(tops) > model.size[2] / 2


def test_doors_swing_within_their_own_width():
    """Fully open, a leaf lies before the frame, no wider than the opening."""
    for hinge, side in (("left", -1), ("right", 1)):
        model = door(0.985, 0.1, 2.05, hinge=hinge).build("door")
        T = link_transforms(model.robot, {"leaf_joint": 1.57})["leaf"]
        points = np.concatenate([h.vertices for h in model.robot.link("leaf").hulls])
        leaf = points @ T[:3, :3].T + T[:3, 3]
        assert np.all(np.abs(leaf[:, 0]) < model.size[0] / 2 + 0.01)
        assert np.median(side * leaf[:, 0]) > 0.35 and leaf[:, 1].min() < -0.8


def test_levers_turn_on_their_leaf_and_rest_against_their_stop():
    model = double_door(1.6, 0.1, 2.08).build("door")
    parents = {joint.child: joint for joint in model.robot.moving_joints}
    assert [parents[f"lever_{k}"].parent for k in (1, 2)] == ["leaf_1", "leaf_2"]
    for name in ("lever_1", "lever_2"):
        link, joint = model.robot.link(name), parents[name]
        # Gravity's moment about the spindle pushes below zero, where the limit is.
        torque = np.cross(link.com, [0, 0, -9.81 * link.mass_kg]) @ joint.axis
        assert torque < 0 == joint.lower


def test_desk_lamps_are_balanced_about_every_joint():
    model = arm_lamp(0.18, 0.5, 0.46).build("lamp")
    poses = link_transforms(model.robot)
    carried = {"arm_1": ["arm_1", "arm_2", "head"], "arm_2": ["arm_2", "head"], "head": ["head"]}
    for joint in model.robot.moving_joints:
        links = [model.robot.link(name) for name in carried[joint.child]]
        moment = sum(
            k.mass_kg * ((poses[k.name] @ np.append(k.com, 1))[1] - poses[joint.child][1, 3])
            for k in links
        )
        assert abs(moment) * 9.81 < 0.01 * joint.friction


def test_a_swing_lid_swings_both_ways():
    model = swing_bin(0.3, 0.24, 0.52).build("bin")
    (flap,) = model.robot.moving_joints
    assert flap.lower == -flap.upper < 0
    assert model.robot.link("flap").com[2] < 0  # below its axis: it swings back


def test_stacks_and_shells_have_the_volume_of_their_profiles():
    """A cone's frustum, and its wall; polygons of n sides have n/2 sin(2 pi / n) of r^2 area."""
    sides = 32
    share = sides / 2 * np.sin(2 * np.pi / sides)
    (solid,) = stack([(0.0, 0.1), (0.3, 0.2)], squeeze=0.5, sides=sides)
    frustum = 0.3 / 3 * (0.01 + 0.02 + 0.04) * share
    assert sound.volume_of(solid.mesh()) == pytest.approx(0.5 * frustum, rel=1e-4)
    wall = shell([(0.0, 0.1), (0.2, 0.1), (0.3, 0.1)], [0.09] * 3, sides=sides)
    ring = 0.3 * (0.01 - 0.0081) * share
    assert sum(sound.volume_of(s.mesh()) for s in wall) == pytest.approx(ring, rel=1e-3)
    assert len(wall) == 2 * sides


def test_walls_are_as_thick_across_a_slope_as_elsewhere():
    upright, slanted = (
        inner_radii([(0.0, 0.1), (0.1, 0.1)], 0.004),
        inner_radii([(0.0, 0.1), (0.1, 0.2)], 0.004),
    )
    assert upright == [0.096, 0.096]
    assert slanted[0] == pytest.approx(0.1 - 0.004 * np.sqrt(2), abs=1e-6)


def test_strips_are_mitred_and_cut():
    """A right angle of a strip 10 mm wide loses no volume and gains none; cut ends lie level."""
    bent = strip([(0.0, 0.0), (0.0, 0.1), (0.1, 0.1)], 0.01, "x", (0.0, 0.02))
    volume = sum(sound.volume_of(s.mesh()) for s in bent)
    assert volume == pytest.approx(0.02 * 0.01 * 0.2, rel=1e-4)
    arch = strip([(-0.1, 0.0), (0.0, 0.1), (0.1, 0.0)], 0.01, "y", (0.0, 0.02), (1.0, 0.0))
    points = np.concatenate([s.vertices for s in arch])
    assert points[:, 2].min() == pytest.approx(0.0, abs=1e-12)
    assert np.ptp(points[:, 1]) == pytest.approx(0.02)


def test_spikes_and_raised_outlines_are_solids():
    spiky = spike((0, 0, 0), (0.01, 0.02), (0.1, 0, 0.3), (0.005, 0.01), 0.7)
    area = 4 * np.array([0.01 * 0.02, 0.005 * 0.01])
    volume = 0.3 / 3 * (area.sum() + np.sqrt(area.prod()))
    assert sound.volume_of(spiky.mesh()) == pytest.approx(volume, rel=1e-4)
    slanted = raised(np.array([[0, 0, 0], [0.1, 0, 0.05], [0, 0.1, 0.0]]), 0.002)
    assert sound.volume_of(slanted.mesh()) == pytest.approx(0.005 * 0.002, rel=1e-3)


def test_levels_of_detail_change_round_parts_only():
    """A cup's wall has as many staves as sides; its size and its handle stay."""
    row = row_of("cup", "mug")
    low, medium, high = (row.design(detail=d) for d in ("low", "medium", "high"))
    links = [design.build("cup").robot.links[0] for design in (low, medium, high)]
    assert [len(link.hulls) for link in links] == [8 + 4, 16 + 4, 32 + 4]
    for design in (low, high):
        np.testing.assert_allclose(design.size, medium.size, atol=1e-9)
    assert links[2].mass_kg == pytest.approx(links[1].mass_kg, rel=0.03)
