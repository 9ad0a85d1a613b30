"""The kit's core: builder, rows, levels of detail, fitting, textures; on small designs."""

from __future__ import annotations

import inspect

import hypothesis
import hypothesis.strategies as st
import numpy as np
import pytest

import isr_jax as isr
from isr_jax.cad.kit import FIT_RANGE, KIT, ModelBuilder, fit_cad, make, row
from isr_jax.cad.kit import catalogue as catalogue_module
from isr_jax.cad.kit.materials import GLASS, OAK, STEEL
from isr_jax.cad.kit.solids import box, circle, frustum, plane_axes, split, tube
from isr_jax.errors import SettingError
from isr_jax.robot_model import link_transforms

from . import kit_soundness as sound

FITTED = (
    "bookshelf/wide_120",
    "cabinet/sideboard_120",
    "chair/office_48",
    "chair/spindle_43",
    "desk/pedestal_door_150x70",
    "sofa/chaise_240",
    "stool/bar_column_42",
    "table/oval_200x100",
    "wardrobe/sliding_270",
)


def cupboard(width: float, depth: float, height: float, *, knob: float = 0.02) -> ModelBuilder:
    """A box with a door that carries a knob, given child first."""
    builder = ModelBuilder("cabinet", symmetry=1)
    x, y = width / 2, depth / 2
    builder.add(OAK, box((-x, x), (-y + 0.03, y), (0.0, height)))
    builder.add(
        STEEL,
        box((-knob, knob), (-y - 0.03, -y - 0.002), (0.5, 0.5 + knob)),
        link="knob",
        handle=True,
    )
    builder.add(GLASS, box((-x, x), (-y, -y + 0.02), (0.0, height)), link="door")
    builder.knob("knob", (0.0, -y, 0.5), (0, -1, 0), 1.0, parent="door", lower_rad=-0.5)
    builder.hinge("door", (-x, -y, height / 2), (0, 0, -1), 1.5)
    return builder


def test_builder_puts_the_origin_in_the_middle_and_joins_coplanar_faces():
    builder = ModelBuilder("table", symmetry=1)
    builder.add(OAK, box((0.0, 0.4), (0.0, 0.3), (0.0, 0.02)))
    builder.add(OAK, box((0.404, 0.8), (0.0, 0.3), (0.0, 0.02)))
    builder.add(OAK, box((0.8, 1.0), (0.0, 0.3), (0.0, 0.1)))
    np.testing.assert_allclose(builder.size, [1.0, 0.3, 0.1])
    model = builder.build("two_boards")
    assert model.id == "table/two_boards" and model.mount == "floor"
    np.testing.assert_allclose(model.size, [1.0, 0.3, 0.1])
    assert sound.supporting_heights(model) == [0.02, 0.1]
    k = int(
        np.argmax(
            model.planes.area_m2 * (model.planes.corners[:, 0, 2] < 0) * model.plane_supporting
        )
    )
    # The 4 mm joint belongs to the rectangle, not to the area.
    width = np.ptp(model.planes.corners[k, :, 0])
    assert width == pytest.approx(0.8) and model.planes.area_m2[k] == pytest.approx(0.796 * 0.3)


def test_a_knob_on_a_door_turns_with_it():
    model = cupboard(0.6, 0.4, 0.8).build("one")
    assert [j.parent for j in model.robot.joints] == ["base", "door"]
    assert model.moving_joints == ("door_joint", "knob_joint")
    assert [link.name for link in model.robot.links] == ["base", "door", "knob"]
    center = np.array([0.0, 0.0, 0.4])
    closed = link_transforms(model.robot)
    np.testing.assert_allclose(
        closed["knob"][:3, 3], np.array([0.0, -0.2, 0.5]) - center, atol=1e-7
    )
    opened = link_transforms(model.robot, {"door_joint": np.pi / 2})
    # The door turns about (-0.3, -0.2): the knob, 0.3 m to the right, comes to stand before it.
    np.testing.assert_allclose(opened["knob"][:3, 3], [-0.3, -0.5, 0.1], atol=1e-6)
    knob = model.robot.joints[1]
    assert (knob.lower, knob.upper) == (-0.5, 1.0)


def test_hands_take_handles_stated_points_or_the_far_edge():
    handles = {h.joint: h for h in cupboard(0.6, 0.4, 0.8).build("one").handles}
    knob, door = handles["knob_joint"], handles["door_joint"]
    assert not knob.estimated and door.estimated
    np.testing.assert_allclose(knob.position, [0.0, -0.016, 0.01], atol=1e-9)
    # The rear edge of the free side is farthest from the hinge; its middle is at half height.
    np.testing.assert_allclose(door.position, [0.6, 0.02, 0.0], atol=1e-9)
    builder = ModelBuilder("cabinet", symmetry=1)
    builder.add(OAK, box((0.0, 1.0), (0.0, 1.0), (0.0, 1.0)))
    builder.add(OAK, box((0.2, 0.8), (-0.02, 0.0), (0.2, 0.6)), link="drawer")
    builder.add(OAK, box((0.2, 0.8), (-0.02, 0.0), (0.7, 0.9)), link="flap")
    builder.slide("drawer", (0, -1, 0), 0.3)
    builder.hinge("flap", (0.5, -0.02, 0.7), (1, 0, 0), 1.0, at=(0.3, -0.02, 0.9))
    drawer, flap = builder.build("two").handles
    assert drawer.estimated and not flap.estimated
    np.testing.assert_allclose(drawer.position, [0.0, -0.51, -0.1], atol=1e-9)
    np.testing.assert_allclose(flap.position, [-0.2, 0.0, 0.2], atol=1e-9)


def test_friction_is_that_of_the_largest_surface_and_mounts_can_be_overridden():
    builder = ModelBuilder("bookshelf", symmetry=1, mount="wall")
    builder.add(OAK, box((0.0, 0.1), (0.0, 0.1), (0.0, 0.1)))
    builder.add(GLASS, box((0.1, 0.9), (0.0, 0.1), (0.0, 0.01)))
    model = builder.build("pane")
    assert model.mount == "wall"
    assert model.robot.links[0].friction == GLASS.friction != OAK.friction


def test_parts_without_extent_are_refused():
    with pytest.raises(SettingError, match=r"0\.3 m to 0\.2 m"):
        box((0.0, 1.0), (0.3, 0.2), (0.0, 1.0))
    with pytest.raises(SettingError, match="larger"):
        frustum((0.1, 0.1), (0.5, 0.5))


def test_textures_have_their_true_size_on_every_polygon():
    model = make("chair/cafe_42")
    for visual in model.robot.links[0].visuals:
        mesh, uv = visual.mesh, visual.mesh.uv
        assert uv is not None and uv.shape == (len(mesh.faces), 3, 2)
        corners = mesh.vertices.astype(np.float64)[mesh.faces]
        for a, b in ((0, 1), (1, 2), (2, 0)):
            length = np.linalg.norm(corners[:, a] - corners[:, b], axis=1)
            flat = np.linalg.norm(uv[:, a] - uv[:, b], axis=1)
            np.testing.assert_allclose(flat, length, atol=2e-4)  # uv are rounded to 0.1 mm
        edges = uv[:, 1:] - uv[:, :1]
        turned = edges[:, 0, 0] * edges[:, 1, 1] - edges[:, 0, 1] * edges[:, 1, 0]
        assert (turned > -1e-6).all()  # no texture is mirrored


@hypothesis.given(st.tuples(*[st.floats(-1, 1)] * 3).filter(lambda v: np.linalg.norm(v) > 0.1))
def test_axes_on_a_plane_are_right_handed_and_level(values):
    normal = np.array(values) / np.linalg.norm(values)
    u, v = plane_axes(normal)
    hypothesis.assume(abs(normal[2]) <= 0.999)
    np.testing.assert_allclose(np.cross(u, v), normal, atol=1e-12)
    assert u[2] == 0 and v[2] >= 0


def test_tubes_are_hollow_and_may_be_oval():
    for scale in ((1.0, 1.0), (1.0, 0.6)):
        half = [(r * scale[0], r * scale[1]) for r in (0.1, 0.09)]
        outer, inner = (np.stack([circle(r)] * 2) for r in half)
        volume = sum(sound.volume_of(s.mesh()) for s in tube(outer, inner, (0.0, 0.2)))
        ring, hole = (sound.volume_of(frustum((r, r), (0.0, 0.2)).mesh()) for r in half)
        assert volume == pytest.approx(ring - hole, rel=1e-4)
        np.testing.assert_allclose(np.ptp(outer[0], 0), 2 * np.array(half[0]))


def test_split_keeps_its_ends():
    assert split(-0.123456, 0.3, 3) == [-0.123456, 0.0177, 0.1588, 0.3]
    assert split(0.0, 1.0, 1) == [0.0, 1.0]


def test_levels_of_detail_change_round_parts_only():
    counts = [
        len(make("table/round_90", detail).mesh.faces) for detail in ("low", "medium", "high")
    ]
    assert counts[0] < counts[1] < counts[2]
    square = [make("table/dining_120x75", detail).content_hash for detail in ("low", "high")]
    assert square[0] == square[1]
    with pytest.raises(SettingError, match="low, medium, high"):
        make("table/round_90", "ultra")


@pytest.mark.parametrize("detail", ["low", "high"])
@pytest.mark.parametrize("cad_id", ["chair/armchair_tub_72", "stool/bar_column_back_45"])
def test_every_level_of_detail_is_sound(cad_id, detail):
    model = make(cad_id, detail)
    sound.assert_hulls_are_closed_convex_and_small(model)
    sound.assert_visuals_are_the_skin_of_the_hulls(model)
    np.testing.assert_allclose(model.size, KIT[cad_id].size, atol=1e-4)


def test_options_follow_the_box():
    made = row("one", cupboard, 0.6, 0.4, 0.8).having(follows={"knob": 2}, knob=0.03)
    part = next(
        link for link in made.design((0.6, 0.4, 1.6)).build("x").robot.links if link.name == "knob"
    )
    assert np.ptp(part.hulls[0].vertices[:, 0]) == pytest.approx(0.12)


def test_every_row_is_in_the_kit_once():
    rows = sum(len(rows) for group in catalogue_module._GROUPS for rows in group.values())
    assert rows == len(KIT)
    for cad_id, made in KIT.items():
        known = set(inspect.signature(made.maker).parameters)
        assert set(made.options) | set(made.follows) <= known, cad_id


def test_unknown_models_name_the_nearest():
    with pytest.raises(SettingError, match="chair/ladder_42"):
        make("chair/lader_42")


@pytest.mark.parametrize("cad_id", FITTED)
@pytest.mark.parametrize("factors", [(0.8, 1.3, 1.1), (1.5, 0.9, 0.8)])
def test_fitted_models_have_the_asked_box_and_stay_sound(cad_id, factors):
    size = [round(f * s, 4) for f, s in zip(factors, KIT[cad_id].size, strict=True)]
    model = fit_cad(cad_id, size)
    np.testing.assert_allclose(model.size, size, atol=1.1e-4)
    assert model.id != cad_id and cad_id in model.notes[0]
    sound.assert_hulls_are_closed_convex_and_small(model)
    sound.assert_parts_do_not_overlap(model)
    sound.assert_opens_towards_a_hand(model)
    if model.articulated:
        sound.assert_moving_parts_keep_clear(model, np.random.default_rng(0))


def test_boards_and_handles_keep_their_thickness_when_fitted():
    model, larger = make("cabinet/base_40"), fit_cad("cabinet/base_40", (0.6, 0.58, 0.86))

    def thinnest(of) -> list[float]:
        sizes = [np.ptp(h.vertices, 0).min() for link in of.robot.links for h in link.hulls]
        return sorted({round(float(v), 4) for v in sizes})

    assert thinnest(model) == thinnest(larger)
    assert larger.moving_joints == model.moving_joints


@pytest.mark.parametrize("old", ["fit"])
def test_the_old_name_of_fit_cad_says_the_new_one(old):
    with pytest.warns(DeprecationWarning, match="fit_cad"):
        assert getattr(isr, old) is fit_cad


def test_fitting_takes_a_model_or_its_id_and_the_same_size_changes_nothing_else():
    model = make("chair/ladder_42")
    same = fit_cad(model, KIT[model.id].size)
    np.testing.assert_array_equal(same.mesh.vertices, model.mesh.vertices)
    assert same.id == "chair/ladder_42_420x486x860"


@pytest.mark.parametrize(
    ("size", "said"),
    [
        ((0.1, 0.486, 0.86), r"width 0.1 m for chair/ladder_42, which is 0.42 m"),
        ((0.42, 0.486, 2.0), r"give 0.516 to 1.38 m|give 0.516 to 1.376 m"),
        ((0.42, 0.486), "give width, depth and height"),
    ],
)
def test_sizes_that_cannot_be_fitted_name_the_allowed_range(size, said):
    with pytest.raises(SettingError, match=said):
        fit_cad("chair/ladder_42", size)
    assert FIT_RANGE == (0.6, 1.6)


def test_what_makes_no_object_is_refused():
    """An office chair's seat does not fit on a foot of 0.38 m by 1.06 m."""
    width, depth, height = KIT["chair/office_48"].size
    with pytest.raises(SettingError):
        fit_cad("chair/office_48", (1.6 * width, 0.6 * depth, height))
