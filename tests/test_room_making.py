"""Rooms that stand: what moves or overlaps goes, with what it carries, and nothing else."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import numpy as np
import pytest

from isr_jax.cad import default_library
from isr_jax.demonstration.room_making import (
    MAX_DRIFT_M,
    MAX_PENETRATION_M,
    StandingRoom,
    made_to_stand,
    standing_room,
)
from isr_jax.errors import SceneError
from isr_jax.library import CadLibrary
from isr_jax.scene_file import read_scene
from isr_jax.synthetic import Room
from isr_jax.synthetic.room import ROOM_KINDS, PlacedModel

from .builders import library_of, table_model, without_hulls
from .films import Recorder
from .furniture import block_model, cabinet_model, furniture_library
from .hand_made_rooms import placed, room_with

TABLE = table_model()
BOOK, CUP = block_model("book/a", (0.2, 0.26, 0.03)), block_model("cup/a", (0.08, 0.08, 0.1))
TOP_M = 0.74
"""Of the table, which is 1.2 m by 0.8 m."""


def library_for(room: Room) -> CadLibrary:
    return library_of(*{item.model.id: item.model for item in room.items}.values())


def stood(*items: PlacedModel, twin_dir: Path | None = None, reporter=None) -> StandingRoom:
    room = room_with(*items)
    return made_to_stand(room, library_for(room), twin_dir=twin_dir, reporter=reporter)


def on_table(id: int, model, x: float, bottom: float = TOP_M, parent: str = "table_2", y=0.0):
    return placed(id, model, (x, y, bottom + float(model.size[2]) / 2), parent)


def table() -> PlacedModel:
    return placed(2, TABLE, (0.0, 0.0, 0.37), "floor_1")


def test_what_stands_stays_where_it_is(tmp_path: Path):
    items = (
        table(),
        on_table(3, BOOK, 0.0),
        on_table(4, CUP, 0.0, TOP_M + 0.03, "book_3"),
        placed(5, cabinet_model(), (1.4, 0.0, 0.43), "floor_1"),
    )
    result = stood(*items, twin_dir=tmp_path)
    assert result.removed == () and result.rounds == 1 and result.room.notes == ()
    for before, after in zip(items, result.room.items, strict=True):
        np.testing.assert_allclose(after.T_world_cad, before.T_world_cad, atol=1e-5)
    report = result.report.exported
    assert {body.name for body in report.bodies} == {"book_3", "cup_4"}
    assert max(body.drift_end_m for body in report.bodies) < 1e-3
    assert report.penetration_max_m < MAX_PENETRATION_M and report.end_s == pytest.approx(5)
    scene = read_scene(tmp_path / "scene.json")
    assert scene.entity("cup_4").parent == "book_3"
    stored = json.loads((tmp_path / "stability.json").read_text())
    assert stored["exported"]["rates"]["within_1_cm"] == 1.0


def test_what_falls_goes_with_what_it_carries(tmp_path: Path):
    """A book with 60 % of its length past the table's edge at x = 0.6 tips; the cup rides on it."""
    recorder = Recorder()
    items = (
        table(),
        on_table(3, BOOK, 0.62),
        on_table(4, CUP, 0.66, TOP_M + 0.03, "book_3"),
        on_table(5, CUP, -0.3),
    )
    result = stood(*items, twin_dir=tmp_path, reporter=recorder)
    assert result.removed == ("book_3", "cup_4") and result.rounds == 2
    assert not list((tmp_path / "assets").glob("book_3*"))
    assert list((tmp_path / "assets").glob("cup_5*"))
    assert [item.name for item in result.room.items] == ["table_2", "cup_5"]
    notes = " ".join(result.room.notes)
    assert "book_3 taken away: moved" in notes and "cup_4" in notes and "cup_5" not in notes
    assert all(any(note in said for said in recorder.notes) for note in result.room.notes)


def test_of_two_that_overlap_the_later_one_goes():
    """The bottle reaches 7 cm into the microwave."""
    items = (
        table(),
        on_table(3, block_model("microwave/a", (0.48, 0.36, 0.28)), 0.0),
        on_table(4, block_model("bottle/a", (0.08, 0.08, 0.3)), 0.21),
    )
    result = stood(*items)
    assert result.removed == ("bottle_4",)
    assert "70.0 mm of microwave_3 in bottle_4" in result.room.notes[0]


@pytest.mark.parametrize(("above_m", "stays"), [(0.003, True), (0.03, False)])
def test_a_little_air_is_taken_out_and_more_is_not(above_m, stays):
    """Import hulls swell by millimetres: the room takes over where things then stand."""
    result = stood(table(), on_table(3, CUP, 0.1, TOP_M + above_m))
    assert result.removed == (() if stays else ("cup_3",))
    if stays:
        bottom = result.room.item("cup_3").center[2] - 0.05
        assert bottom == pytest.approx(TOP_M, abs=2e-5)
        assert "cup_3 farthest, by 3.0 mm" in result.room.notes[0]
    else:
        assert "moved 30.0 mm" in result.room.notes[0]


def test_what_leans_stands_by_friction_or_goes():
    """A board of 2 cm by 60 cm against the wall at y = 2: at 0.2 rad it holds, on its own it falls.

    With friction 0.8 at both ends it slips from tan(angle) = 2 * 0.8 / (1 - 0.64) = 4.4 on.
    """
    board, c, s = block_model("box/a", (0.4, 0.02, 0.6)), np.cos(0.2), np.sin(0.2)
    T = np.eye(4, dtype=np.float32)
    T[:3, :3] = [[1, 0, 0], [0, c, s], [0, -s, c]]  # the upper end towards +y
    depth, height = 0.02 * c + 0.6 * s, 0.02 * s + 0.6 * c
    T[:3, 3] = [0.0, 2.0 - depth / 2, height / 2]
    leaning = dataclasses.replace(
        placed(2, board, (0.0, 0.0, 0.0), None), T_world_cad=T, attachment="leaning"
    )
    assert stood(leaning).removed == ()
    away = T.copy()
    away[1, 3] -= 0.5
    kept = placed(3, TABLE, (-1.0, -1.0, 0.37), "floor_1")
    alone = dataclasses.replace(leaning, T_world_cad=away)
    assert stood(alone, kept).removed == ("box_2",)


def test_what_hangs_and_stuff_are_fixed():
    picture = block_model("picture/a", (0.5, 0.02, 0.4))
    hung = dataclasses.replace(placed(2, picture, (0.0, 1.98, 1.5), None), attachment="wall")
    lamp = dataclasses.replace(
        placed(3, block_model("lamp/a", (0.3, 0.3, 0.3)), (0.0, 0.0, 2.2), None),
        attachment="hanging",
    )
    result = stood(hung, lamp)
    assert result.removed == () and result.report.exported.bodies == ()
    assert set(result.report.fixed) | set(result.report.anchored) >= {"picture_2", "lamp_3"}


@pytest.mark.slow
def test_models_without_hulls_get_them():
    bare = dataclasses.replace(without_hulls(BOOK), content_hash="")
    result = stood(table(), on_table(3, bare, 0.0))
    assert result.removed == () and result.room.item("book_3").model.collision == "vhacd"
    assert result.library.by_id("book/a").collision == "vhacd"


def test_the_same_room_is_the_same_twin(tmp_path: Path):
    for name in ("first", "second"):
        stood(table(), on_table(3, BOOK, 0.1), on_table(4, CUP, 0.62), twin_dir=tmp_path / name)
    for name in ("scene.xml", "scene.json"):
        assert (tmp_path / "first" / name).read_bytes() == (tmp_path / "second" / name).read_bytes()


def test_a_made_room_stands(tmp_path: Path):
    result = standing_room(3, furniture_library(), twin_dir=tmp_path)
    drift = [body.drift_end_m for body in result.report.exported.bodies]
    assert len(result.room.items) >= 8 and len(drift) >= 3 and max(drift) < MAX_DRIFT_M
    names = {item.name for item in result.room.items}
    assert not names & set(result.removed)
    assert {e.name for e in read_scene(tmp_path / "scene.json").entities if e.cad} == names


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(1, 11))
def test_ten_rooms_stand(seed):
    kind = ROOM_KINDS[seed % len(ROOM_KINDS)]
    result = standing_room(seed, default_library(), kind=kind)
    assert max(body.drift_end_m for body in result.report.exported.bodies) < MAX_DRIFT_M
    assert len(result.room.things) >= 20 and len(result.removed) <= 3


def test_a_room_that_never_stands_is_refused(monkeypatch):
    monkeypatch.setattr("isr_jax.demonstration.room_making._ROUNDS", 1)
    with pytest.raises(SceneError, match="book_3"):
        stood(table(), on_table(3, BOOK, 0.62))
