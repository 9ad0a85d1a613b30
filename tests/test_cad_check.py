"""`isr cad check` finds what is wrong, says where, and lets pass what is sound."""

from __future__ import annotations

import dataclasses
import json
import re

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull

from isr_jax.cad import save_model
from isr_jax.cad.checking.check import check_library
from isr_jax.cad.checking.hand import smooth
from isr_jax.cad.checking.model import check_model, farthest_point
from isr_jax.cad.checking.planes import plane_faults
from isr_jax.cad.checking.report import CHECKS
from isr_jax.cad.checking.settings import CheckSettings
from isr_jax.cad.checking.static import hull_problem
from isr_jax.errors import LibraryError, SettingError
from isr_jax.library import CadModel
from isr_jax.robot_model import box_between
from isr_jax.runtime.render_text import render_text
from isr_jax.types import Mesh, PlaneSet

from .builders import library_of, parts_model, table_model
from .opening_models import (
    SIZE,
    door_model,
    drawer_model,
    wheel_model,
    with_joint,
    with_link,
)

BOUNDS = CheckSettings()


def reasons(model: CadModel, **changes) -> dict[str, str]:
    """What is wrong with a model, by check."""
    found = check_model(model, CheckSettings(**changes))
    return {
        check: "; ".join(f.reason for f in found.faults if f.check == check)
        for check in CHECKS
        if found.outcome(check) == "failed"
    }


@pytest.mark.parametrize(
    "model",
    [
        table_model(),
        door_model(),
        door_model(mount="wall"),
        drawer_model(),
        wheel_model(),
    ],
    ids=["table", "door", "door on a wall", "drawer", "wheel"],
)
def test_sound_models_pass(model):
    found = check_model(model)
    assert found.passed, found.faults
    assert found.drift_m is not None and found.drift_m < 1e-4
    if model.articulated:
        assert found.share is not None and found.share > 0.99


# hulls


def sphere(count: int) -> Mesh:
    rng = np.random.default_rng(0)
    points = rng.normal(size=(count, 3))
    points /= np.linalg.norm(points, axis=1, keepdims=True)
    hull = ConvexHull(points)
    faces = hull.simplices.copy()
    corners = points[faces]
    inward = (
        np.einsum(
            "fc,fc->f",
            np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]),
            corners[:, 0],
        )
        < 0
    )
    faces[inward] = faces[inward, ::-1]
    return Mesh(points.astype(np.float32), faces.astype(np.int32))


def test_hulls_that_are_none_are_named():
    cube = box_between(np.zeros(3), np.ones(3))
    assert not hull_problem(cube, BOUNDS) and not hull_problem(sphere(64), BOUNDS)
    assert "65 vertices" in hull_problem(sphere(65), BOUNDS)
    assert "closed" in hull_problem(dataclasses.replace(cube, faces=cube.faces[:-1]), BOUNDS)
    inside_out = dataclasses.replace(cube, faces=np.ascontiguousarray(cube.faces[:, ::-1]))
    assert "inside out" in hull_problem(inside_out, BOUNDS)
    nan = cube.vertices.copy()
    nan[0, 0] = np.nan
    assert "no numbers" in hull_problem(dataclasses.replace(cube, vertices=nan), BOUNDS)


@given(st.integers(0, 63), st.floats(0.1, 0.9))
@settings(max_examples=30, deadline=None)
def test_a_pushed_in_corner_is_not_convex(corner, share):
    ball = sphere(64)
    vertices = ball.vertices.copy()
    vertices[corner] *= -share  # through the middle: its faces cut the ball
    assert hull_problem(dataclasses.replace(ball, vertices=vertices), BOUNDS)


def test_hulls_stay_within_what_is_seen_or_the_stated_swelling():
    model = table_model()
    link = model.robot.links[0]
    low, high = link.hulls[0].vertices.min(0), link.hulls[0].vertices.max(0)
    swollen = with_link(
        model, "base", hulls=(box_between(low - 0.004, high + 0.004), *link.hulls[1:])
    )
    assert "4.0 mm out of what is seen" in reasons(swollen)["hulls"]
    assert "hulls" not in reasons(dataclasses.replace(swollen, swelling_m=0.0041))


def test_links_that_overlap_at_rest_are_named_with_the_depth():
    found = reasons(door_model(gap_m=-0.002))
    assert "base and door overlap by 2.00 mm at rest" in found["hulls"]


# inertia


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"mass_kg": 0.0}, "mass 0 kg"),
        ({"inertia": np.diag([1.0, 1.0, -0.1])}, "least moment"),
        ({"inertia": np.diag([1.0, 1.0, 2.5])}, "triangle"),
        ({"inertia": np.array([[1.0, 0.5, 0], [0, 1, 0], [0, 0, 1]])}, "symmetric"),
        ({"com": np.array([0.0, 0.0, 5.0])}, "outside"),
        ({"mass_kg": 9000.0}, "kg, where a table of its size"),
    ],
)
def test_impossible_masses_and_inertias(changes, says):
    assert says in reasons(with_link(table_model(), "base", **changes))["inertia"]


def test_what_cannot_be_simulated_is_said_to_be_skipped():
    found = check_model(with_link(table_model(), "base", mass_kg=0.0))
    assert found.outcome("standing") == found.outcome("opening") == "skipped"
    bare = check_model(dataclasses.replace(table_model(), collision="none"))
    assert bare.passed
    assert {c for c in CHECKS if bare.outcome(c) == "skipped"} == {"hulls", "standing", "opening"}


# joints


@pytest.mark.parametrize(
    ("changes", "says"),
    [
        ({"axis": np.array([0.0, 0.0, 2.0])}, "not of length 1"),
        ({"lower": 0.2, "upper": 1.0}, "do not contain 0"),
        ({"lower": 0.0, "upper": 0.0}, "no range"),
        ({"damping": -1.0}, "must be >= 0"),
    ],
)
def test_joints_that_cannot_be_right(changes, says):
    assert says in reasons(with_joint(door_model(), **changes))["joints"]


def test_handles_belong_to_the_joint_and_to_the_moved_link():
    model = door_model()
    handle = model.handles[0]

    def with_handle(**changes) -> CadModel:
        return dataclasses.replace(model, handles=(dataclasses.replace(handle, **changes),))

    assert "no handle" in reasons(dataclasses.replace(model, handles=()))["joints"]
    assert "does not move" in reasons(with_handle(link="base"))["joints"]
    assert "500 mm off" in reasons(with_handle(position=np.array([0.1, -0.52, 0.0])))["joints"]


# planes


def plane_reasons(model: CadModel, **changes) -> str:
    """What is wrong with the model's planes when some of their arrays are changed."""
    planes = {field: np.array(getattr(model.planes, field)) for field in vars(model.planes)}
    changed = dataclasses.replace(model, planes=PlaneSet(**(planes | changes)))
    return "; ".join(plane_faults(changed, BOUNDS))


def test_planes_that_are_off_their_surface_or_no_rectangles():
    model = door_model()
    normal, area = np.array(model.planes.normal), np.array(model.planes.area_m2)
    corners, offset = np.array(model.planes.corners), np.array(model.planes.offset)
    assert not plane_reasons(model)
    sunk, skew = corners.copy(), corners.copy()
    sunk[0, :, 2] -= 0.005
    skew[0, 2, 0] += 0.1
    lower = offset + np.array([0.005, 0], np.float32)
    assert "0 % of it is surface" in plane_reasons(model, corners=sunk, offset=lower)
    assert "beside it" in plane_reasons(model, corners=sunk)
    assert "no rectangle" in plane_reasons(model, corners=skew)
    assert "clockwise" in plane_reasons(model, corners=corners[:, ::-1])
    assert "normal of length" in plane_reasons(model, normal=2 * normal)
    assert "area" in plane_reasons(model, area_m2=2 * area)
    wide, farther = np.array([1.1, 1, 1], np.float32), np.array([1, 1.1], np.float32)
    assert "out of the box" in plane_reasons(model, corners=corners * wide, offset=offset * farther)


def test_classes_that_carry_need_a_plane_that_does():
    model = dataclasses.replace(door_model(), plane_supporting=np.zeros(2, bool))
    assert "can carry" in plane_reasons(model)
    sideways = dataclasses.replace(model, plane_supporting=np.array([True, True]))
    assert "does not face up" in plane_reasons(sideways)


# standing and opening


def test_what_falls_over_or_drops_is_told_by_how_far():
    leaning = parts_model(
        "table/leaning",
        "table",
        [((0.1, 0.1, 0.7), (-0.35, 0, -0.05)), ((0.8, 0.5, 0.1), (0, 0, 0.35))],
    )
    found = check_model(leaning)
    assert found.outcome("standing") == "failed"
    assert found.drift_m is not None and found.drift_m > 0.3  # it lies on its edge


def test_an_unbalanced_flap_falls_open():
    flap = with_joint(door_model(mount="wall", friction=0.0), axis=np.array([0.0, 1.0, 0.0]))
    assert "hanging" in reasons(flap)["standing"]


def test_a_flap_that_friction_holds_does_not_creep():
    """Friction three times the moment of its weight, for 5 s."""
    door = door_model(mount="wall").robot.link("door")
    moment = 9.81 * door.mass_kg * float(door.com[0])
    held_up = door_model(mount="wall", friction=3 * moment)
    found = check_model(with_joint(held_up, axis=np.array([0.0, 1.0, 0.0])))
    assert found.drift_m is not None and found.drift_m < 2e-4


def test_a_door_that_hits_its_carcass_is_found_by_geometry():
    """Hinged 10 mm behind its front corner, a door swings its rear edge into the side."""
    model = door_model(gap_m=0.0005)
    found = reasons(
        with_joint(
            model,
            T_parent_child=model.robot.joints[0].T_parent_child,
            axis=np.array([0.0, 0.0, 1.0]),
        )
    )
    assert "base and door overlap" in found["opening"] and "degrees" in found["opening"]


def test_a_drawer_that_is_blocked_says_by_what_and_how_far_it_came():
    model = drawer_model()
    base = model.robot.link("base")
    x, y, z = SIZE / 2
    stop = box_between(np.array([-x, -y - 0.12, -z]), np.array([x, -y - 0.1, -z + 0.1]))
    blocked = with_link(model, "base", hulls=(*base.hulls, stop))
    found = reasons(blocked)["opening"]
    assert "base and drawer overlap" in found
    assert "base fixed: only 41 % of its range" in found and "base touches drawer" in found


@pytest.mark.parametrize("friction", [5.0, 20.0])
def test_the_hand_pulls_a_little_more_than_the_friction(friction):
    found = check_model(drawer_model(friction=friction))
    assert found.passed and found.effort_n is not None
    block = drawer_model().robot.link("drawer").mass_kg
    # least jerk over 0.3 m in 1.2 s accelerates by 5.8 * 0.3 / 1.2^2; the damping adds its part
    moving = block * 5.8 * 0.3 / 1.2**2 + 6.0 * 1.875 * 0.3 / 1.2
    assert friction < found.effort_n < friction + 1.6 * moving


def test_a_joint_that_needs_more_than_the_hand_gives_does_not_open():
    found = reasons(drawer_model(friction=80.0))["opening"]
    assert re.search("base fixed: only [01] % of its range under 60 N at its handle", found)
    stronger = reasons(drawer_model(friction=80.0), force_n=150.0)
    assert "of its range" not in stronger.get("opening", "")


def test_a_door_that_stands_on_the_floor_opens_only_where_the_base_is_fixed():
    found = reasons(with_link(door_model(lift_m=0.0), "door", friction=1.0), force_n=20.0)
    assert set(found) <= {"opening"}
    model = door_model(lift_m=0.0, density=100.0)
    heavy = with_link(model, "door", mass_kg=80.0, inertia=np.diag([5.0, 5.0, 5.0]))
    found = reasons(heavy, force_n=20.0)["opening"]
    assert "base free" in found and "door touches the floor" in found


def test_a_light_cabinet_with_a_heavy_drawer_tips_over():
    found = reasons(drawer_model(0.35, density=150.0, inside=900.0))["opening"]
    assert "base free: it tips by" in found and "base fixed" not in found


def test_a_handle_on_the_axis_turns_nothing():
    found = reasons(wheel_model(arm_m=0.0))
    assert "only 0 % of its range" in found["opening"]


def test_a_wheel_must_make_a_full_turn():
    wheel = wheel_model()
    assert "opening" not in reasons(wheel)
    base = wheel.robot.link("base")
    z = SIZE[2] / 2
    pin = box_between(np.array([0.11, 0.0, z]), np.array([0.13, 0.02, z + 0.02]))
    assert "overlap" in reasons(with_link(wheel, "base", hulls=(*base.hulls, pin)))["opening"]


def test_the_point_farthest_from_a_hinge_is_the_free_edge():
    model = door_model()
    point = farthest_point(model.robot, model.robot.joints[0])
    assert point[0] == pytest.approx(SIZE[0]) and point[1] == pytest.approx(-0.02)


def test_least_jerk_starts_and_ends_at_rest():
    s = np.linspace(0, 1, 1001)
    way, rate = np.array([smooth(v) for v in s]).T
    assert way[0] == 0 and way[-1] == pytest.approx(1)
    assert rate[0] == rate[-1] == pytest.approx(0)
    np.testing.assert_allclose(np.gradient(way, s)[1:-1], rate[1:-1], atol=1e-4)


def test_bounds_have_bounds():
    with pytest.raises(SettingError, match="force_n"):
        CheckSettings(force_n=-1.0)


# libraries


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """Three models on disk: a sound one, one without a handle, one whose mesh was changed."""
    root = tmp_path_factory.mktemp("library")
    for model in (
        table_model(),
        dataclasses.replace(door_model(), id="cabinet/no_handle", handles=()),
        dataclasses.replace(drawer_model(), id="cabinet/changed"),
    ):
        save_model(model, root)
    mesh = next((root / "cabinet" / "changed" / "meshes").iterdir())
    mesh.write_text(mesh.read_text() + "# changed\n")
    return root


def test_a_folder_is_checked_to_its_end(folder):
    told = []
    report = check_library(
        folder, workers=1, progress=lambda done, total: told.append((done, total))
    )
    assert told == [(1, 3), (2, 3), (3, 3)]
    assert [m.id for m in report.failed] == ["cabinet/changed", "cabinet/no_handle"]
    assert not report.passed
    assert report.models[0].outcome("files") == "failed"
    assert report.models[0].outcome("standing") == "skipped"
    text = render_text(report.table())
    assert "door_joint: no handle" in text and "content hash" in " ".join(text.split())
    assert "2 of 3 models failed" in text and "table/test" not in text
    assert "table/test" in render_text(report.table(every_model=True))
    record = json.loads(report.json())
    assert record["passed"] is False and len(record["models"]) == 3
    assert record["models"][2]["outcome"] == dict.fromkeys(CHECKS, "passed")


def test_workers_find_the_same_as_one_process(folder):
    def found(workers: int) -> list:
        report = check_library(folder, workers=workers)
        return [dataclasses.replace(model, seconds=0.0) for model in report.models]

    assert found(1) == found(2)


def test_only_what_is_asked_for_is_checked(folder):
    assert [m.id for m in check_library(folder, workers=1, only=["table"]).models] == ["table/test"]
    both = check_library(library_of(table_model(), door_model()), workers=1, only=["cabinet/test"])
    assert [m.id for m in both.models] == ["cabinet/test"]
    with pytest.raises(LibraryError, match="no model sofa") as raised:
        check_library(folder, only=["sofa"])
    assert "cabinet, table" in raised.value.hint


def test_a_folder_without_models_is_refused(tmp_path):
    with pytest.raises(LibraryError, match="no CAD models"):
        check_library(tmp_path)


def test_hulls_are_made_where_there_are_none_and_asked_for(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    bare = with_link(table_model(), "base", hulls=())
    bare = dataclasses.replace(bare, collision="none")
    skipped = check_library(library_of(bare), workers=1).models[0]
    assert skipped.passed and skipped.drift_m is None
    assert "--hulls vhacd" in render_text(check_library(library_of(bare), workers=1).table())
    made = check_library(library_of(bare), workers=1, hulls="vhacd").models[0]
    assert made.passed and not made.skipped and made.drift_m is not None, made.faults
