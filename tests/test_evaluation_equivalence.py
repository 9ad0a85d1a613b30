"""Functional equivalence: the true model scores 1, and each change loses what it must."""

from __future__ import annotations

import dataclasses
import itertools

import numpy as np
import pytest

from isr_jax.config import DEFAULT_SUPPORT, SupportSettings
from isr_jax.errors import SceneError, SettingError
from isr_jax.evaluation import stage
from isr_jax.evaluation.matches import Match
from isr_jax.evaluation.models.affordance import (
    MovingPart,
    asked_places,
    carrying_agreement,
    joint_agreement,
    moving_parts,
    supporting_rectangles,
    volume_agreement,
)
from isr_jax.evaluation.models.appearance import delta_e, lab_of_srgb, mean_lab
from isr_jax.evaluation.models.cad_alignment import AlignmentLimits
from isr_jax.evaluation.models.cad_cases import PosedModel
from isr_jax.evaluation.models.equivalence import combined, grade, upright_box
from isr_jax.evaluation.models.relations import class_agreement
from isr_jax.evaluation.models.replacement import ReplacementScores, score_replacement
from isr_jax.evaluation.result_files import Result, Truth, support_of
from isr_jax.evaluation.standing import read_standing
from isr_jax.library import CadModel
from isr_jax.robot_model import RobotModel
from isr_jax.scene_file import CadRecord, EntityRecord, SceneFile, read_scene, write_scene
from isr_jax.types import Candidate

from .builders import floor_entity, library_of, rotation_z, table_model, with_robot
from .evaluation_folders import make_folders
from .furniture import block_model, cabinet_model, chair_model
from .reference import cad_measures_reference as slow

ONES = np.ones(3)


def pose(yaw: float = 0.0, center=(0.0, 0.0, 0.0)) -> np.ndarray:
    T = np.eye(4)
    T[:3, :3], T[:3, 3] = rotation_z(yaw), center
    return T


def rigid(model: CadModel) -> CadModel:
    """The same to look at, but nothing moves."""
    (hinge,) = model.robot.joints
    still = RobotModel("still", model.robot.links, (dataclasses.replace(hinge, kind="fixed"),))
    return dataclasses.replace(
        with_robot(model, still), id=f"{model.id}_rigid", content_hash=f"{model.id}_rigid"
    )


def painted(model: CadModel, rgba) -> CadModel:
    (link,) = model.robot.links
    visuals = tuple(
        dataclasses.replace(v, rgba=rgba, mesh=dataclasses.replace(v.mesh, colors=None))
        for v in link.visuals
    )
    robot = RobotModel("painted", (dataclasses.replace(link, visuals=visuals),), ())
    return dataclasses.replace(
        with_robot(model, robot), id=f"{model.id}_painted", content_hash=f"{model.id}_painted"
    )


# A floor; a table at (0, 0) with a cup and a microwave on it; a cabinet; a chair.
CHAIR = dataclasses.replace(chair_model(), symmetry=1)
CABINET = dataclasses.replace(cabinet_model(), symmetry=1)
CUP, OVEN = block_model("cup/a", (0.08, 0.08, 0.1)), block_model("microwave/a", (0.48, 0.36, 0.28))
TABLE = table_model()
PLACES = {
    "table_2": (TABLE, pose(0.2, (0, 0, 0.37)), "floor_1"),
    "cup_3": (CUP, pose(0.5, (0.3, 0.1, 0.79)), "table_2"),
    "microwave_4": (OVEN, pose(0.2, (-0.2, 0, 0.88)), "table_2"),
    "cabinet_5": (CABINET, pose(-0.4, (2.0, 0.5, 0.43)), "floor_1"),
    "chair_6": (CHAIR, pose(1.0, (-1.5, 1.0, 0.44)), "floor_1"),
}
OTHERS = (
    rigid(CABINET),
    painted(CHAIR, (0.05, 0.1, 0.9, 1.0)),
    table_model("table/low", (1.2, 0.8, 0.45)),
    dataclasses.replace(table_model("desk/b"), class_name="desk"),
    dataclasses.replace(block_model("cabinet/solid", (0.6, 0.56, 0.86)), symmetry=1),
)
LIBRARY = library_of(TABLE, CUP, OVEN, CABINET, CHAIR, *OTHERS)


def entity(name: str, model: CadModel, T: np.ndarray, parent: str | None) -> EntityRecord:
    class_name, id = name.rsplit("_", 1)
    posed = PosedModel(model, np.asarray(T, float), ONES)
    cad = CadRecord(model.id, T.astype(np.float32), np.ones(3, np.float32), 0.1, 0.01)
    return EntityRecord(
        id=int(id),
        name=name,
        class_name=class_name,
        type="articulated" if model.articulated else "rigid",
        box=upright_box(posed),
        planes=(),
        parent=parent,
        attachment="none",
        support_plane=0,
        mesh=None,
        cad=cad,
        candidates=(Candidate(model.id, 0, 0.1, 0.01, "converged", None),),
    )


def floor() -> EntityRecord:
    made = floor_entity(1)
    return EntityRecord(
        1, made.name, "floor", "layout", made.box, (), "room", "none", None, None, None
    )


def scored(
    changes=None, T_truth_result=None, missing=(), support=DEFAULT_SUPPORT
) -> ReplacementScores:
    """Scores of the true scene with some entities changed; ``missing`` ones match nothing."""
    true = [floor(), *(entity(name, *place) for name, place in PLACES.items())]
    found = [dataclasses.replace(e, **(changes or {}).get(e.name, {})) for e in true]
    T = np.eye(4) if T_truth_result is None else T_truth_result
    back = np.linalg.inv(T)
    found = [
        e
        if e.cad is None
        else dataclasses.replace(
            e,
            cad=dataclasses.replace(
                e.cad, T_world_cad=(back @ e.cad.T_world_cad).astype(np.float32)
            ),
        )
        for e in found
    ]
    none = np.zeros(0, np.int64)
    matches = tuple(
        Match(n, None, "none", 0.0) if n in missing else Match(n, n, "segments", 1.0)
        for n in PLACES
    )
    points = np.zeros((0, 3))
    return score_replacement(
        Truth(SceneFile(tuple(true), np.eye(4)), points, none, none, None),
        Result(SceneFile(tuple(found), back), points, np.zeros((0, 3), np.int64), none, none, T),
        matches,
        LIBRARY,
        LIBRARY,
        AlignmentLimits(),
        support,
    )


def stands_for(name: str, model: CadModel, yaw: float = 0.0, lift: float = 0.0) -> dict:
    """Another model in a thing's place, turned and lifted there."""
    _, T, parent = PLACES[name]
    return {name: {"cad": entity(name, model, T @ pose(yaw, (0, 0, lift)), parent).cad}}


def rows_of(scores: ReplacementScores):
    return {r.truth: r for r in scores.equivalence.rows}


def test_the_true_models_in_place_score_1():
    scores = scored()
    e = scores.equivalence
    assert e.score == e.class_score == e.equivalent == 1.0
    assert e.articulated_affordance == pytest.approx(1.0)
    for r in e.rows:
        parts = (r.relations, r.affordance, r.geometry, r.appearance)
        np.testing.assert_allclose(parts, 1.0, atol=1e-3)
        assert r.grades == (2, 2, 2, 2)
    assert scores.retrieval.top1 == scores.retrieval.top10 == scores.retrieval.top1_matching == 1.0
    assert scores.scan2cad.official.instances == scores.scan2cad.strict.classes == 1.0
    assert scores.chamfer.two_way_median_m < 1e-4
    assert scores.chamfer.alignment_error_median_m == pytest.approx(0.01)
    assert rows_of(scores)["cabinet_5"].details.joints == 1.0
    assert rows_of(scores)["cup_3"].details.joints is None


def test_another_world_changes_nothing():
    T = pose(1.1, (0.5, -2.0, 0.03))
    here, there = scored(stands_for("chair_6", CHAIR, np.pi)), None
    there = scored(stands_for("chair_6", CHAIR, np.pi), T_truth_result=T)
    for a, b in zip(here.equivalence.rows, there.equivalence.rows, strict=True):
        assert a.grades == b.grades
        np.testing.assert_allclose(
            (a.relations, a.affordance, a.geometry, a.appearance),
            (b.relations, b.affordance, b.geometry, b.appearance),
            atol=2e-3,
        )


def losses(changes, name: str) -> set[str]:
    """The criteria of a thing that a change costs; nothing else may lose any."""
    rows = rows_of(scored(changes))
    assert all(r.score == 1.0 for n, r in rows.items() if n != name)
    parts = ("relations", "affordance", "geometry", "appearance")
    return {p for p, g in zip(parts, rows[name].grades, strict=True) if g < 2}


def test_a_rigid_stand_in_loses_affordance_alone():
    changes = stands_for("cabinet_5", OTHERS[0])
    assert losses(changes, "cabinet_5") == {"affordance"}
    row = rows_of(scored(changes))["cabinet_5"]
    assert (row.details.joints, row.details.openable, row.details.carrying) == (0.0, 0.0, 1.0)
    # of 80 points affordance has 9 a grade, and both grades are lost
    assert row.score == pytest.approx((80 - 18) / 80) and not row.equivalent


def test_a_model_turned_round_keeps_its_class():
    assert losses(stands_for("chair_6", CHAIR, np.pi), "chair_6") == {"geometry"}
    changes = stands_for("cabinet_5", CABINET, np.pi)
    row = rows_of(scored(changes))["cabinet_5"]
    # The hinge still turns about z, but the door is on the other side and opens to there. Its box
    # is the same, and of its shape only the door has moved.
    assert row.details.joints == 0.5 and row.details.openable == pytest.approx(1.0)
    assert row.details.box_iou == pytest.approx(1.0, abs=1e-4) and row.details.shape < 1.0
    assert "affordance" in losses(changes, "cabinet_5") and row.grades[0] == row.grades[3] == 2


def test_another_paint_loses_appearance_alone():
    assert losses(stands_for("chair_6", OTHERS[1]), "chair_6") == {"appearance"}


def test_another_class_of_the_group_is_partly_the_class():
    changes = stands_for("table_2", OTHERS[3])
    assert losses(changes, "table_2") == {"relations"}
    assert rows_of(scored(changes))["table_2"].grades[0] == 1
    assert class_agreement("table", "cup") == class_agreement("cup", "bowl") == 0.0
    assert class_agreement("cabinet", "wall_cabinet") == 0.5


def test_a_low_table_carries_nothing_at_the_right_height():
    low = stands_for("table_2", OTHERS[2], lift=-(0.74 - 0.45) / 2)
    row = rows_of(scored(low))["table_2"]
    assert row.details.carrying == 0.0 and row.grades[:2] == (2, 0)
    # size: (0 + 0 + |0.45 / 0.74 - 1|) / 3 = 0.1306 of 0.5; box IoU 0.45 / 0.74
    assert row.details.size == pytest.approx(1 - 0.13063 / 0.5, abs=1e-3)
    assert row.details.box_iou == pytest.approx(0.45 / 0.74, abs=1e-3)


def test_swapped_parents_lose_relations():
    changes = {"cup_3": {"parent": "floor_1"}}
    rows = rows_of(scored(changes))
    assert rows["cup_3"].relations == 0.0 and rows["cup_3"].grades[1:] == (2, 2, 2)
    # the table keeps its own support and one child of two: F1 = 2 * 2 / (3 + 2)
    assert rows["table_2"].details.supports == pytest.approx(0.8)
    assert rows["microwave_4"].score == 1.0
    # on the microwave: both the cup's edge and one of the microwave's are wrong
    rows = rows_of(scored({"cup_3": {"parent": "microwave_4"}}))
    assert rows["microwave_4"].details.supports == pytest.approx(2 * 1 / (1 + 2))
    rows = rows_of(scored({"chair_6": {"parent": None, "attachment": "leaning"}}))
    assert rows["chair_6"].relations == 0.0


def test_what_is_missing_scores_0_and_a_scan_what_it_keeps():
    scores = scored(missing=("cup_3",))
    rows = rows_of(scores)
    assert rows["cup_3"].score == 0.0 and rows["cup_3"].predicted is None
    assert scores.retrieval.top1 == pytest.approx(0.8)
    assert scores.retrieval.top1_of_found == 1.0
    scan = {"cabinet_5": {"cad": None, "type": "scan"}}
    row = rows_of(scored(scan))["cabinet_5"]
    assert row.id is None and row.relations == 1.0 and row.appearance == 0.0
    assert row.details.joints == 0.0 and row.details.carrying == 0.0  # it has no plane
    assert row.details.shape is None and row.geometry == pytest.approx(1.0, abs=1e-3)


def test_moving_something_farther_loses_ever_more():
    scores = []
    for step in (0.0, 0.02, 0.1, 0.5):
        T = PLACES["chair_6"][1].copy()
        T[0, 3] += step
        cad = entity("chair_6", CHAIR, T, "floor_1").cad
        scores.append(rows_of(scored({"chair_6": {"cad": cad}}))["chair_6"])
    assert [r.relations for r in scores] == [1.0] * 4
    geometry = [r.geometry for r in scores]
    assert geometry == sorted(geometry, reverse=True) and geometry[-1] < 0.5


def test_earlier_criteria_dominate():
    every = list(itertools.product(range(3), repeat=4))
    by_score = sorted(every, key=combined)
    assert by_score == every  # the order of a dictionary
    assert [slow.lexicographic_rank(g) for g in by_score] == list(range(81))
    assert combined((2, 2, 2, 2)) == 1.0 and combined((0, 0, 0, 0)) == 0.0
    assert [grade(p) for p in (0.0, 0.49, 0.5, 0.89, 0.9, 1.0)] == [0, 0, 1, 1, 2, 2]


# -- affordance ---------------------------------------------------------------------------------


def part(
    slides=False, axis=(0, 0, 1), place=(0, 0, 0), opens=0.1, endless=False, to=(0, -1, 0)
) -> MovingPart:
    axis, to, place = (np.asarray(v, float) for v in (axis, to, place))
    return MovingPart(slides, axis / np.linalg.norm(axis), to, endless, place, opens)


@pytest.mark.parametrize(
    ("true", "placed", "expected"),
    [
        ([], [], None),
        ([part()], [part()], 1.0),
        ([part()], [], 0.0),
        ([], [part()], 0.0),
        ([part()], [part(slides=True)], 0.0),
        ([part()], [part(axis=(0, 0, -1))], 0.75),  # hung on the other side
        ([part()], [part(to=(1, 0, 0))], 0.75),  # on another face
        ([part()], [part(to=(0, 0, 0))], 1.0),  # turns about its middle
        ([part(endless=True)], [part(axis=(0, 0, -1))], 1.0),  # a knob has no sense
        ([part()], [part(place=(0.3, 0, 0))], 0.75),
        ([part()], [part(axis=(1, 0, 0), place=(0.3, 0, 0))], 0.5),
        ([part()], [part(axis=(0, np.sin(0.3), np.cos(0.3)))], 1.0),  # 17 degrees
        ([part()], [part(axis=(0, np.sin(0.4), np.cos(0.4)))], 0.75),  # 23 degrees
        # two doors, one of them found: 2 * 1 / (2 + 1)
        ([part(), part(place=(1, 0, 0))], [part(place=(1, 0, 0))], 2 / 3),
        # the assignment is the best one, not the first: a door and a drawer, listed crosswise
        ([part(), part(slides=True)], [part(slides=True), part()], 1.0),
    ],
)
def test_joint_agreement_by_hand(true, placed, expected):
    assert joint_agreement(true, placed) == (None if expected is None else pytest.approx(expected))


def test_a_door_in_the_world_by_hand():
    # The door of the cabinet is 0.59 x 0.018 x 0.85 m and closes a model 0.56 m deep: it opens
    # 0.59 * 0.85 * 0.56 m^3 (the handle is part of its box, which is 0.048 m thick then). It opens
    # towards negative angles about +z, so its sense is -z. Twice as large: eight times the room.
    (door,) = moving_parts(PosedModel(CABINET, pose(0.5, (1, 2, 3)), 2 * ONES))
    assert not door.slides and not door.endless
    np.testing.assert_allclose(door.axis, [0, 0, -1], atol=1e-6)
    # -z x (from the hinge at the left edge of the front to the middle, nearly +x) is nearly -y
    assert door.opens_to @ (rotation_z(0.5) @ [0, -1, 0]) > 0.99
    assert door.opens_m3 == pytest.approx(8 * 0.59 * 0.85 * 0.56, rel=1e-4)
    low, high = np.array([-0.295, -0.33, -0.425]), np.array([0.295, -0.282, 0.425])
    # doubled; along x the door reaches from 5 mm to 595 mm of a width that begins at -0.3 m
    middle = 2 * np.array([0.0, (low + high)[1] / 2, 0.0])
    np.testing.assert_allclose(door.place, rotation_z(0.5) @ middle + [1, 2, 3], atol=1e-4)


def test_openable_room_is_smaller_over_larger():
    # 0.027 / 0.216 = 1 / 8, of lengths 1 / 2
    assert volume_agreement([part(opens=0.216)], [part(opens=0.027)]) == pytest.approx(0.5)
    two = [part(opens=0.1), part(opens=0.1)]
    assert volume_agreement([part(opens=0.1)], two) == pytest.approx(0.5 ** (1 / 3))
    assert volume_agreement([], [part()]) is None
    assert volume_agreement([part()], []) == 0.0


def test_places_and_planes_by_hand():
    table = PosedModel(TABLE, pose(0.2, (0, 0, 0.37)), ONES)
    cup = entity("cup_3", *PLACES["cup_3"])
    places = asked_places(table, [cup])
    np.testing.assert_allclose(places, [[0.3, 0.1, 0.74], [0, 0, 0.74]], atol=1e-5)
    top = supporting_rectangles(table)
    assert carrying_agreement(places, top) == 1.0
    assert carrying_agreement(places, top + np.array([0, 0, 0.049])) == 1.0
    assert carrying_agreement(places, top + np.array([0, 0, 0.051])) == 0.0
    # 0.8 m along its length the middle is still over the top (0.6 + 0.05 m) of neither
    away = rotation_z(0.2) @ np.array([0.8, 0, 0])
    assert carrying_agreement(places, top + away) == 0.5
    assert carrying_agreement(np.zeros((0, 3)), top) is None
    # upside down nothing faces up but the undersides, which are no supporting planes
    flipped = pose()
    flipped[:3, :3] = np.diag([1.0, -1.0, -1.0])
    assert len(supporting_rectangles(PosedModel(TABLE, flipped, ONES))) == 0


def tilted(T: np.ndarray, angle: float) -> np.ndarray:
    turn = np.eye(4)
    turn[1:3, 1:3] = [[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]]
    return T @ turn


def test_what_faces_up_is_a_setting():
    """A table tilted by 30 degrees: its normal has a cosine of 0.87 with up."""
    table = PosedModel(TABLE, tilted(pose(), np.pi / 6), ONES)
    assert len(supporting_rectangles(table)) == 0
    assert len(supporting_rectangles(table, SupportSettings(up_cosine=0.8))) > 0


def test_one_support_reaches_the_score():
    name = "table_2"
    lying = tilted(PLACES[name][1], 0.05)
    cad = entity(name, TABLE, lying, "floor_1").cad
    carrying = {
        up: rows_of(scored({name: {"cad": cad}}, support=SupportSettings(up_cosine=up)))[
            name
        ].details.carrying
        for up in (0.9, 0.9999)
    }
    # a_th = 0.9999 lets 0.8 degrees pass: the true, level top asks, the tilted one (2.9) is none
    assert carrying[0.9] > 0 and carrying[0.9999] == 0


@pytest.mark.parametrize(("said", "expected"), [({}, 0.9), ({"support": {"up_cosine": 0.7}}, 0.7)])
def test_evaluation_reads_the_support_of_the_run(tmp_path, monkeypatch, said, expected):
    folders, used = make_folders(tmp_path), []
    path = folders.write() / "scene.json"
    write_scene(dataclasses.replace(read_scene(path), settings=said), path)
    monkeypatch.setattr(stage, "score_replacement", lambda *arguments: used.append(arguments[-1]))
    stage.evaluate(path.parent, folders.truth, library=LIBRARY)
    stage.evaluate(
        path.parent, folders.truth, library=LIBRARY, support=SupportSettings(up_cosine=0.5)
    )
    assert [support.up_cosine for support in used] == [expected, 0.5]


def test_a_support_that_cannot_be_is_refused():
    scene = SceneFile((), np.eye(4), settings={"support": {"up_cosine": 2.0}})
    with pytest.raises(SettingError, match="up_cosine"):
        support_of(scene)


# -- appearance ---------------------------------------------------------------------------------


def test_colours_as_scikit_image():
    skimage_color = pytest.importorskip("skimage.color")
    rng = np.random.default_rng(5)
    rgb = np.concatenate(
        [rng.uniform(0, 1, (200, 3)), np.eye(3), np.zeros((1, 3)), np.ones((1, 3))]
    )
    lab = lab_of_srgb(rgb)
    np.testing.assert_allclose(lab, skimage_color.rgb2lab(rgb), atol=2e-2)
    greys = np.repeat(rng.uniform(0, 100, (5, 1)), 3, 1) * [1, 0, 0]
    lab = np.concatenate([lab, greys])
    for a, b in zip(lab, rng.permutation(lab), strict=True):
        assert delta_e(a, b) == pytest.approx(skimage_color.deltaE_ciede2000(a, b), abs=1e-6)
        assert delta_e(a, b) == pytest.approx(delta_e(b, a), abs=1e-9)
        assert delta_e(a, a) == 0.0


@pytest.mark.parametrize(
    ("a", "b", "expected"),
    [  # rows 1, 7, 17, 20 and 25 of the test data of Sharma, Wu and Dalal 2005
        ((50, 2.6772, -79.7751), (50, 0, -82.7485), 2.0425),
        ((50, 0, 0), (50, -1, 2), 2.3669),
        ((50, 2.5, 0), (73, 25, -18), 27.1492),
        ((50, 2.5, 0), (58, 24, 15), 19.4535),
        ((60.2574, -34.0099, 36.2677), (60.4626, -34.1751, 39.4387), 1.2644),
    ],
)
def test_colour_differences_of_the_literature(a, b, expected):
    assert delta_e(np.array(a, float), np.array(b, float)) == pytest.approx(expected, abs=1e-4)


def test_mean_colour_counts_area():
    # a block of one colour has that colour; without colours there is none
    block = painted(block_model("box/x", (1, 1, 1)), (1.0, 0.0, 0.0, 1.0))
    found = mean_lab(block.mesh)
    np.testing.assert_allclose(found, lab_of_srgb(np.array([1.0, 0, 0])), atol=1e-6)
    assert mean_lab(dataclasses.replace(block.mesh, colors=None)) is None
    # half of the area black: lightness halves (L* of red is 53.24)
    faces, colors = block.mesh.faces, block.mesh.colors.copy()
    order = block.mesh.vertices[faces].mean(1)[:, 2].argsort()
    split = np.repeat(np.arange(len(faces) * 3).reshape(-1, 3), 1, 0)
    apart = dataclasses.replace(
        block.mesh,
        vertices=block.mesh.vertices[faces].reshape(-1, 3),
        faces=split.astype(np.int32),
        colors=np.repeat(colors[faces[:, 0]], 3, 0),
    )
    dark = np.repeat(np.isin(np.arange(len(faces)), order[: len(faces) // 2]), 3)
    apart.colors[dark] = 0
    assert mean_lab(apart)[0] == pytest.approx(53.24 / 2, abs=0.01)


# -- the judge beside it ------------------------------------------------------------------------


def test_without_a_verdict_there_is_none(tmp_path):
    assert read_standing(tmp_path) is None
    (tmp_path / "stability.json").write_text("{}")
    with pytest.raises(SceneError, match=r"stability\.json cannot be read"):
        read_standing(tmp_path)
