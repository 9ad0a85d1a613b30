"""ISR-Stab: still scenes are still, falling ones fall, and nobody leaves the denominator."""

from __future__ import annotations

import dataclasses
import io
import json
from xml.etree import ElementTree

import mujoco
import numpy as np
import pytest
from rich.console import Console

from isr_jax.borders.simulation import Trajectory
from isr_jax.config import ExportSettings, StabilitySettings
from isr_jax.errors import SceneError
from isr_jax.evaluation.standing import read_standing
from isr_jax.export import export_scene
from isr_jax.scene_file import read_scene, write_scene
from isr_jax.stability import judge, settle
from isr_jax.stability.measures import (
    body_motions,
    geodesic_angle,
    joint_motions,
    rates,
    tilt_angle,
    variant_rates,
)
from isr_jax.types import UNSUPPORTED

from .physics_scenes import cubes_scene, furnished_scene

QUICK = StabilitySettings(duration_s=2.0, perturbed_resets=2)
STILL_M = 1e-3


@pytest.fixture(scope="module")
def still(tmp_path_factory):
    """Folder and report of the furnished scene, at full length."""
    folder = tmp_path_factory.mktemp("still")
    export_scene(*furnished_scene().arguments, folder)
    return folder, settle(folder / "scene.xml")


def test_what_rests_stands_still(still):
    report = still[1].exported
    assert {m.name for m in report.bodies} == {"cup_4", "chair_5"}
    assert all(m.drift_end_m < STILL_M and m.path_m < STILL_M for m in report.bodies)
    assert report.penetration_max_m < 1e-4 and report.warnings == {}
    assert report.rates is not None and report.rates.within_1_cm == 1.0
    assert report.variants.phyrecon == report.variants.molmospaces_bodies == 1.0
    assert report.variants.molmospaces_joints == 1.0
    assert max(j.share_of_range for j in report.joints) < 0.01
    assert still[1].resets.survived == 8


def test_everything_freed_shows_the_standing_too(still):
    report = still[1]
    assert report.anchored == ("floor_1", "wall_2", "clock_7")
    assert {m.name for m in report.freed.bodies} == {"table_3", "cup_4", "chair_5", "cabinet_6"}
    assert all(m.drift_end_m < STILL_M for m in report.freed.bodies)
    assert report.fixed == ("table_3", "cabinet_6")


def test_reconstruction_error_stands_beside(still):
    assert np.isclose(still[1].alignment_error_mean_m, 0.012)
    assert still[1].scans_kept == 2


def test_report_is_json_and_a_table(still, tmp_path):
    report = still[1]
    report.write(tmp_path / "stability.json")
    data = json.loads((tmp_path / "stability.json").read_text())
    assert data["exported"]["rates"]["total"] == 2
    text = io.StringIO()
    Console(width=140, file=text).print(report.table())
    text = text.getvalue()
    assert "chair_5" in text and "8 of 8" in text


def test_settling_repeats_exactly(still):
    again = settle(still[0] / "scene.xml")
    assert again == still[1]


def test_what_floats_falls_and_is_reported(tmp_path):
    scene = cubes_scene((0, 0, 0.1), (1, 0, 0.8), parents=[0, UNSUPPORTED])
    export_scene(*scene.arguments, tmp_path)
    report = settle(tmp_path / "scene.xml", QUICK).exported
    motion = {m.name: m for m in report.bodies}
    assert motion["cup_2"].drift_end_m < STILL_M
    assert np.isclose(motion["cup_3"].drop_end_m, 0.7, atol=0.01)
    assert motion["cup_3"].path_m > 0.69
    assert report.rates is not None
    assert report.rates.within_20_cm == 0.5 and report.rates.total == 2
    # two seconds are too short for either variant: said, not guessed
    assert report.variants.phyrecon is None and report.variants.molmospaces_bodies is None


def test_overlap_at_the_start_has_its_true_depth(tmp_path):
    # 3 cm into the floor, more than export may mend (its bound is 1 cm here)
    scene = cubes_scene((0, 0, 0.07))
    settings = dataclasses.replace(ExportSettings(), max_shift_m=0.01)
    export_scene(*scene.arguments, tmp_path, settings)
    report = settle(tmp_path / "scene.xml", QUICK).exported
    assert np.isclose(report.penetration_max_m, 0.03, atol=1e-5)
    (overlap,) = report.overlaps
    assert (overlap.body_a, overlap.body_b) == ("floor_1", "cup_2")
    assert report.contacts >= 4


def test_what_falls_out_of_the_room_is_counted(tmp_path):
    scene = cubes_scene((0, 0, 0.1), (1, 0, 0.1), parents=[0, UNSUPPORTED])
    export_scene(*scene.arguments, tmp_path)
    tree = ElementTree.parse(tmp_path / "scene.xml")
    tree.find(".//body[@name='cup_3']").set("pos", "30 0 0.1")  # far past the floor
    tree.write(tmp_path / "scene.xml")
    report = settle(tmp_path / "scene.xml", QUICK)
    assert report.exported.left_room == 1
    assert {m.name for m in report.exported.bodies if m.left_room} == {"cup_3"}
    assert report.resets.survived == 0 and report.resets.body_survival == 0.5


def test_entities_without_a_body_stay_in_the_denominator(tmp_path):
    scene = cubes_scene((0, 0, 0.1))
    export_scene(*scene.arguments, tmp_path)
    stored = read_scene(tmp_path / "scene.json")
    lost = dataclasses.replace(stored.entities[1], id=9, name="cup_9")
    write_scene(
        dataclasses.replace(stored, entities=(*stored.entities, lost)), tmp_path / "scene.json"
    )
    report = settle(tmp_path / "scene.xml", QUICK)
    assert report.failed == ("cup_9",)
    assert report.exported.rates is not None
    assert report.exported.rates.within_1_cm == 0.5
    assert report.resets.survived == 2 and report.resets.body_survival == 0.5


def test_without_scene_json_layout_is_what_has_no_mass(tmp_path):
    export_scene(*furnished_scene().arguments, tmp_path)
    (tmp_path / "scene.json").unlink()
    report = settle(tmp_path / "scene.xml", QUICK)
    assert report.anchored == ("floor_1", "wall_2")
    assert report.scans_kept is None and report.failed == ()
    held = settle(tmp_path / "scene.xml", QUICK, anchored=("floor_1", "table_3"))
    assert "table_3" not in {m.name for m in held.freed.bodies}


def test_missing_scene_is_refused(tmp_path):
    with pytest.raises(SceneError, match=r"scene\.xml is not a file"):
        settle(tmp_path / "scene.xml")


def test_a_model_in_memory_is_judged_as_a_file_is(still):
    """As exported to the last bit; what needs the file says that it does."""
    scene_xml, report = still[0] / "scene.xml", still[1]
    compiled = settle(mujoco.MjModel.from_xml_path(str(scene_xml)))
    assert compiled.exported == report.exported
    assert compiled.scene == "MjModel scene" and compiled.scans_kept is None
    assert compiled.freed is None and "MjSpec" in (compiled.not_freed or "")
    assert "cannot be freed" in str(compiled) and compiled.to_json()["freed"] is None
    anchored = report.anchored
    spec = settle(mujoco.MjSpec.from_file(str(scene_xml)), anchored=anchored)
    assert (spec.exported, spec.freed, spec.not_freed) == (report.exported, report.freed, None)


def test_the_number_of_processors_changes_nothing(still, monkeypatch):
    for cores in (1, 5):
        monkeypatch.setattr(judge, "usable_cores", lambda cores=cores: cores)
        assert settle(still[0] / "scene.xml").resets == still[1].resets


def test_only_what_is_static_can_be_anchored(still):
    with pytest.raises(SceneError, match=r"cup_4, tabel_3(.|\n)*table_3"):
        settle(still[0] / "scene.xml", QUICK, anchored=("cup_4", "tabel_3", "table_3"))


def test_a_verdict_without_the_freed_set_stands_beside_the_evaluation(still, tmp_path):
    compiled = settle(mujoco.MjModel.from_xml_path(str(still[0] / "scene.xml")), QUICK)
    compiled.write(tmp_path / "stability.json")
    found = read_standing(tmp_path)
    assert found is not None and found.freed is None
    assert dict(found.headline())["  everything freed"] == "- / - / -"


def turned(axis, angle: float) -> np.ndarray:
    axis = np.asarray(axis, float) / np.linalg.norm(axis)
    return np.array([np.cos(angle / 2), *(np.sin(angle / 2) * axis)])


@pytest.mark.parametrize("angle", [0.0, 1e-7, 0.3, 3.0])
def test_geodesic_angle_is_exact_and_ignores_sign(angle):
    rest = turned([1, 2, 3], 0.7)
    w, v = rest[0], rest[1:]
    t = turned([0, 1, 1], angle)
    other = np.array([w * t[0] - v @ t[1:], *(w * t[1:] + t[0] * v + np.cross(v, t[1:]))])
    assert np.isclose(geodesic_angle(rest, other), angle, rtol=1e-6, atol=1e-12)
    assert np.isclose(geodesic_angle(rest, -other), angle, rtol=1e-6, atol=1e-12)


def test_tilt_ignores_yaw():
    up = turned([0, 0, 1], 0.0)
    assert np.isclose(tilt_angle(up, turned([0, 0, 1], 1.0)), 0.0)
    assert np.isclose(tilt_angle(up, turned([1, 0, 0], 0.2)), 0.2)


def path_of(position: np.ndarray, joint: np.ndarray) -> Trajectory:
    """One body and one joint over 5 s at 50 Hz, upright."""
    n = len(position)
    quaternion = np.tile(turned([0, 0, 1], 0.0), (n, 1, 1))
    time_s = np.linspace(0, 5, n)
    return Trajectory(time_s, ("a",), position[:, None], quaternion, ("j",), joint[:, None], {})


def test_variants_follow_their_own_criteria():
    t = np.linspace(0, 5, 251)
    still, jitter = np.zeros((251, 3)), np.zeros((251, 3))
    jitter[::2, 0] = 0.002  # 0.1 m a second of path, 2 mm of drift
    early = np.zeros((251, 3))
    early[t > 0.5, 2] = -0.3  # falls before MolmoSpaces looks
    quiet, opening = np.zeros(251), np.where(t > 2, 0.2, 0.0)
    rates = [
        variant_rates(path_of(p, j), {"j": 1.0}, 0)
        for p, j in ((still, quiet), (jitter, quiet), (early, opening))
    ]
    assert [r.phyrecon for r in rates] == [1.0, 1.0, 0.0]
    assert [r.molmospaces_bodies for r in rates] == [1.0, 0.0, 1.0]
    assert [r.molmospaces_joints for r in rates] == [1.0, 1.0, 0.0]
    assert variant_rates(path_of(still, quiet), {"j": 1.0}, 3).phyrecon == 0.25
    (motion,) = body_motions(path_of(jitter, quiet), np.full(3, -1), np.full(3, 1), (1.0, 5.0))
    assert motion.drift_end_m < 1e-9 and np.isclose(motion.path_m, 0.002 * 250)


def straight(way_m: float, axis: int = 0) -> np.ndarray:
    """A body that moves evenly along an axis over 5 s."""
    position = np.zeros((251, 3))
    position[:, axis] = np.linspace(0, way_m, 251)
    return position


@pytest.mark.parametrize(
    ("way_m", "expected"),
    [
        (0.009, (1.0, 1.0, 1.0)),
        (0.03, (0.0, 1.0, 1.0)),
        (0.0501, (0.0, 0.0, 1.0)),
        (0.3, (0.0, 0.0, 0.0)),
    ],
)
def test_rates_of_a_body_that_drifts_by_hand(way_m, expected):
    room = np.full(3, -1.0), np.full(3, 1.0)
    moved = body_motions(path_of(straight(way_m), np.zeros(251)), *room, (1.0, 5.0))
    (motion,) = moved
    # evenly over 5 s: a fifth of the way after the first second
    assert motion.drift_early_m == pytest.approx(way_m / 5)
    assert motion.drift_end_m == motion.path_m == pytest.approx(way_m)
    assert motion.drop_end_m == 0.0 and motion.turn_end_rad == 0.0
    found = rates(moved, 0)
    assert found is not None
    assert (found.within_1_cm, found.within_5_cm, found.within_20_cm) == expected
    # an entity that never became a body halves every share
    halved = rates(moved, 1)
    assert halved is not None and halved.total == 2
    assert halved.within_20_cm == expected[2] / 2


def test_who_left_the_room_is_within_no_limit():
    # out by 2 m and back again: no drift at the end
    position = straight(0.0)
    position[100, 0] = 2.0
    room = np.full(3, -1.0), np.full(3, 1.0)
    moved = body_motions(path_of(position, np.zeros(251)), *room, (1.0, 5.0))
    found = rates(moved, 0)
    assert moved[0].drift_end_m == 0.0 and moved[0].left_room
    assert found is not None and found.within_20_cm == 0.0
    assert rates((), 0) is None


def test_variants_forgive_what_isr_stab_counts():
    """3 cm in the first second, then rest: PhyRecon and MolmoSpaces call it stable."""
    position = straight(0.0)
    position[:50, 0] = np.linspace(0, 0.03, 50)
    position[50:, 0] = 0.03
    path = path_of(position, np.zeros(251))
    variants = variant_rates(path, {"j": 1.0}, 0)
    assert variants.phyrecon == variants.molmospaces_bodies == 1.0
    room = np.full(3, -1.0), np.full(3, 1.0)
    found = rates(body_motions(path, *room, (1.0, 5.0)), 0)
    assert found is not None and (found.within_1_cm, found.within_5_cm) == (0.0, 1.0)
    # a slide of 6 cm between 1 s and 4 s fails MolmoSpaces, but not PhyRecon, which sees drops
    slide = variant_rates(path_of(straight(0.1), np.zeros(251)), {"j": 1.0}, 0)
    assert (slide.phyrecon, slide.molmospaces_bodies) == (1.0, 0.0)
    # 8 cm down in 5 s are 5.3 cm after 3.33 s; 7 cm are 4.7 cm
    falls = [
        variant_rates(path_of(straight(-d, 2), np.zeros(251)), {"j": 1.0}, 0) for d in (0.08, 0.07)
    ]
    assert [f.phyrecon for f in falls] == [0.0, 1.0]


def test_joints_stray_by_their_farthest():
    joint = np.zeros(251)
    joint[120] = -0.3  # there and back
    (motion,) = joint_motions(path_of(straight(0.0), joint), {"j": 1.5})
    assert motion.strayed == pytest.approx(0.3) and motion.share_of_range == pytest.approx(0.2)
    (endless,) = joint_motions(path_of(straight(0.0), joint), {"j": 0.0})
    assert endless.share_of_range is None


def test_the_verdict_stands_beside_the_evaluation(still):
    report = still[1]
    report.write(still[0] / "stability.json")
    found = read_standing(still[0])
    assert found is not None and found.exported.bodies == 2 and found.freed.bodies == 4
    assert found.exported.within_1_cm == found.freed.within_1_cm == 1.0
    assert found.exported.phyrecon == found.exported.molmospaces_bodies == 1.0
    assert found.reset_survival == 1.0 and (found.failed, found.fixed) == (0, 2)
    assert found.alignment_error_mean_m == pytest.approx(0.012)
    assert found.exported.drift_max_m == max(m.drift_end_m for m in report.exported.bodies)
    assert found.exported.penetration_max_m == report.exported.penetration_max_m
    assert dict(found.headline())["  alignment error beside it, mean"] == "12.0 mm"
