"""Furniture of the kit is sound: solids, masses, planes, joints, symmetry; one of each maker.

``-m slow`` takes every model, and compares all files of the committed library.
"""

from __future__ import annotations

import collections
import subprocess
import sys
from pathlib import Path

import mujoco
import numpy as np
import pytest
import yourdfpy

from isr_jax.cad import load_library
from isr_jax.cad.kit import KIT
from isr_jax.classes import class_named
from isr_jax.library import CadLibrary, CadModel
from isr_jax.robot_model import link_transforms

from . import kit_soundness as sound
from .conftest import REPOSITORY

MASS_RANGE_KG = {
    "chair": (2, 40),
    "stool": (1, 12),
    "table": (3.5, 105),
    "desk": (15, 110),
    "sofa": (25, 150),
    "bed": (25, 170),
    "nightstand": (7, 25),
    "wardrobe": (12, 340),
    "cabinet": (10, 130),
    "wall_cabinet": (5, 45),
    "counter": (25, 360),
    "drawer_unit": (10, 100),
    "bookshelf": (3, 80),
}
"""What such things weigh in shops, generously; a worktop of stone alone weighs 150 kg."""
CLASSES = sorted(MASS_RANGE_KG)
MINE = sorted(cad_id for cad_id in KIT if cad_id.split("/")[0] in MASS_RANGE_KG)
NAMED = (
    "bin/square_30",
    "cabinet/base_60_drawers",
    "chair/ladder_42",
    "counter/row_180",
    "bookshelf/wide_120",
    "sofa/seats_2",
    "table/dining_140x80",
    "table/round_90",
    "wall_cabinet/open_middle_120",
)
"""Models that a test below names."""
_BUILD = "import sys; from isr_jax.cad import build_library as b; b(sys.argv[1], ids=sys.argv[2:])"


def one_of_each_maker() -> list[str]:
    """The first row of each pair of class and maker, and of those with round parts or fronts."""
    first = {(i.split("/")[0], KIT[i].maker): i for i in reversed(MINE)}
    return sorted({*first.values(), *NAMED})


def built_in(root: Path, ids: list[str]) -> CadLibrary:
    """Models built by another process, without checks of shapes."""
    command = [sys.executable, "-c", _BUILD, str(root), *ids]
    subprocess.run(command, check=True, capture_output=True, cwd=REPOSITORY)
    return load_library(root)


SAMPLE = pytest.param(one_of_each_maker, id="one of each maker")
ALL = pytest.param(lambda: sorted({*MINE, *NAMED}), id="all", marks=pytest.mark.slow)


@pytest.fixture(scope="module", params=[SAMPLE, ALL])
def built(request, tmp_path_factory) -> CadLibrary:
    return built_in(tmp_path_factory.mktemp("kit"), request.param())


@pytest.fixture(params=CLASSES)
def models(request, built) -> list[CadModel]:
    """Models of one class."""
    return [m for m in built.models if m.class_name == request.param]


def bytes_below(root: Path) -> dict[str, bytes]:
    return {p.relative_to(root).as_posix(): p.read_bytes() for p in root.rglob("*") if p.is_file()}


def test_committed_library_is_what_the_kit_builds(built):
    """Other process, other hash seed, maybe other machine: the same bytes."""
    kept = bytes_below(REPOSITORY / "cad_db")
    fresh = {n: content for n, content in bytes_below(Path(built.source)).items() if "/" in n}
    differing = [name for name in fresh if kept.get(name) != fresh[name]]
    assert not differing, "run `isr cad build` to write cad_db again"


def test_committed_library_is_small_and_varied():
    count = collections.Counter(cad_id.split("/")[0] for cad_id in KIT)
    assert len(KIT) >= 300 and len(count) >= 30 and min(count.values()) >= 4
    assert all(class_named(name).functional for name in count if name != "window")
    assert sum(count[name] for name in CLASSES) >= 150
    kept = bytes_below(REPOSITORY / "cad_db")
    models = {name for name in kept if name.endswith("model.json")}
    assert models == {f"{cad_id}/model.json" for cad_id in KIT}
    assert sum(map(len, kept.values())) < 40e6


def test_hulls_are_closed_convex_and_small(models):
    for model in models:
        sound.assert_hulls_are_closed_convex_and_small(model)


def test_visuals_are_the_closed_skin_of_the_hulls(models):
    for model in models:
        sound.assert_visuals_are_the_skin_of_the_hulls(model)


def test_parts_of_a_link_touch_but_do_not_overlap(models):
    for model in models:
        sound.assert_parts_do_not_overlap(model)


def test_box_is_that_of_the_row_without_handles(models):
    for model in models:
        np.testing.assert_allclose(model.size, KIT[model.id].size, atol=1e-4)
        reach = 0.051 if model.articulated else sound.FLAT_M  # handles stand out to the front
        sides = {1: reach, 0: reach, 3: reach} if model.class_name == "bed" else {1: reach}
        sound.assert_box_is_that_of_the_body(model, sides)


def test_masses_are_those_of_real_things(models):
    for model in models:
        low, high = MASS_RANGE_KG[model.class_name]
        assert low < model.robot.mass_kg < high, (model.id, model.robot.mass_kg)
        for link in model.robot.links:
            moments = np.linalg.eigvalsh(link.inertia)
            assert moments[0] > 0 and moments[0] + moments[1] > moments[2], (model.id, link.name)
            points = np.concatenate([h.vertices for h in link.hulls])
            assert np.all((link.com > points.min(0)) & (link.com < points.max(0)))


@pytest.mark.parametrize(("cad_id", "density"), [("chair/ladder_42", 700), ("bin/square_30", 1050)])
def test_mass_com_and_inertia_against_sampling(built, cad_id, density):
    """Models of one material, against 6e5 random points in their box."""
    model = built.by_id(cad_id)
    rng = np.random.default_rng(0)
    points = rng.uniform(-model.size / 2, model.size / 2, (600_000, 3))
    points = points[sound.inside_any(points, sound.hulls_at_rest(model))]
    weight = density * float(np.prod(model.size, dtype=np.float64)) / 600_000
    com = points.mean(0)
    second = weight * (points - com).T @ (points - com)
    inertia = np.trace(second) * np.eye(3) - second
    link = model.robot.links[0]
    share = 0.03  # about 2e4 points are inside: 0.7 % of standard error
    assert link.mass_kg == pytest.approx(weight * len(points), rel=share)
    np.testing.assert_allclose(link.com, com, atol=share * model.size.max())
    np.testing.assert_allclose(link.inertia, inertia, atol=share * np.trace(inertia))


def test_com_stands_over_the_feet(models):
    for model in models:
        if model.mount != "wall":
            sound.assert_stands_over_its_feet(model)


def test_planes_lie_on_free_surfaces(models):
    rng = np.random.default_rng(0)
    for model in models:
        sound.assert_planes_lie_on_free_surfaces(model, rng)


def test_supporting_planes_face_up_and_are_wide_enough_to_use(models):
    for model in models:
        rows = np.flatnonzero(model.plane_supporting)
        assert len(rows), model.id
        for k in rows:
            corners = model.planes.corners[k]
            sides = np.linalg.norm(corners[[1, 3]] - corners[0], axis=1)
            assert model.planes.normal[k, 2] > 0.9 and sides.min() >= 0.07, (model.id, k)


def test_surfaces_that_carry_are_where_they_should_be(built):
    def only(cad_id: str) -> CadModel:
        return built.by_id(cad_id)

    def heights(cad_id: str) -> list[float]:
        return sound.supporting_heights(only(cad_id))

    table = only("table/dining_140x80")
    assert heights("table/dining_140x80") == [0.75]
    assert table.planes.area_m2[0] == pytest.approx(1.4 * 0.8)
    round_area = 0.5 * 32 * np.sin(2 * np.pi / 32) * 0.45**2  # a polygon of 32 sides
    assert only("table/round_90").planes.area_m2[0] == pytest.approx(round_area, rel=1e-4)
    assert 0.45 in heights("chair/ladder_42")
    assert len(heights("bookshelf/wide_120")) == 11
    assert 0.9 in heights("counter/row_180")
    assert 0.43 in heights("sofa/seats_2")
    drawers = only("cabinet/base_60_drawers")
    owners = {link for link, s in zip(drawers.plane_link, drawers.plane_supporting) if s}
    assert {"drawer_1", "drawer_2", "drawer_3"} < owners


def test_outer_sides_are_kept_however_many_shelves_there_are(built):
    model = built.by_id("wall_cabinet/open_middle_120")
    assert model.plane_supporting.sum() == 10
    for axis, sign in ((0, -1), (0, 1), (1, 1), (2, -1)):
        outer = np.isclose(model.planes.corners[:, 0, axis], sign * model.size[axis] / 2, atol=1e-5)
        facing = np.isclose(model.planes.normal[:, axis], sign, atol=1e-5)
        assert np.any(outer & facing), (axis, sign)


def test_symmetry_is_the_largest_true_one(models):
    for model in models:
        sound.assert_symmetry_is_the_largest_true_one(model)


def test_classes_that_open_do_open(models):
    for model in models:
        info = class_named(model.class_name)
        assert model.mount in (info.mount, "wall")
        if info.articulated:
            assert model.articulated or model.id.startswith("wardrobe/open"), model.id
        sound.assert_opens_towards_a_hand(model)
        for joint in model.robot.moving_joints:
            poses = [link_transforms(model.robot, {joint.name: q}) for q in (0.0, joint.upper)]
            com = np.append(model.robot.link(joint.child).com, 1)
            closed, opened = ((T[joint.child] @ com)[:3] for T in poses)
            if joint.kind != "continuous":
                assert np.linalg.norm(opened - closed) > 0.05, (model.id, joint.name)


def test_moving_parts_keep_clear_of_everything(models):
    rng = np.random.default_rng(0)
    for model in (m for m in models if m.articulated):
        sound.assert_moving_parts_keep_clear(model, rng)


def test_mujoco_reads_every_model(built):
    for model in built.models:
        compiled = mujoco.MjModel.from_xml_path(f"{built.source}/{model.id}/model.urdf")
        assert compiled.njnt == len(model.moving_joints), model.id
        assert compiled.body_mass.sum() == pytest.approx(model.robot.mass_kg, rel=1e-6)


# yourdfpy calls what trimesh has renamed.
@pytest.mark.filterwarnings("ignore:.*Scene.dump:DeprecationWarning")
@pytest.mark.parametrize("class_name", CLASSES)
def test_yourdfpy_reads_one_of_each_class(built, class_name):
    model = max(
        (m for m in built.models if m.class_name == class_name), key=lambda m: m.articulated
    )
    urdf = yourdfpy.URDF.load(f"{built.source}/{model.id}/model.urdf")
    assert list(urdf.actuated_joint_names) == list(model.moving_joints)
    closed = urdf.scene.bounds
    np.testing.assert_allclose(closed[0], model.mesh.vertices.min(0), atol=sound.FLAT_M)
    np.testing.assert_allclose(closed[1], model.mesh.vertices.max(0), atol=sound.FLAT_M)
