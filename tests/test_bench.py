"""The benchmark: a tidy table of every measure, runs that resume, and truths that score as such."""

from __future__ import annotations

import csv
import dataclasses
import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from experiments.bench import __main__ as command
from experiments.bench import held_out, one_run, workers
from experiments.bench.cost import CostMeter
from experiments.bench.headline import HEADLINE
from experiments.bench.intervals import mean_interval, paired_difference
from experiments.bench.one_run import FAILED, RUN, Libraries, kept_rows, run_key
from experiments.bench.oracle import MASKS, NONE, STAGES, true_alignments, true_shortlist
from experiments.bench.plan import IN_LIBRARY, Plan, RoomSpec, Run, room_specs
from experiments.bench.report import means_of, sheets
from experiments.bench.room_figures import room_sheet
from experiments.bench.room_work import RoomWork
from experiments.bench.rows import Row, flatten
from experiments.bench.run_bench import run_plan
from experiments.bench.sheets import write_markdown
from experiments.bench.table import BENCH
from experiments.bench.truth_folder import TrueScene, read_true_scene
from isr_jax import pipeline
from isr_jax.cad import default_library
from isr_jax.demonstration.film import FilmPlan
from isr_jax.errors import LibraryError, OutputError, SceneError, SettingError
from isr_jax.geometry import CUBE_ROTATIONS
from isr_jax.scene_file import read_scene
from isr_jax.stability.report import ResetReport, SetReport, StabilityReport, VariantRates

from .films import COARSE, FRAMES, HEIGHT, WIDTH, Recorder, film  # noqa: F401 (a fixture)

ROOM = RoomSpec(IN_LIBRARY, "kitchen", 100)


def plan_at(folder: Path, *, presets=("default",), truths=("physical_check",)) -> Plan:
    """One tiny room with true masks, and from the truth of these stages."""
    return Plan(
        out_dir=folder,
        rooms=(ROOM,),
        presets=presets,
        levels=("perfect",),
        truths=truths,
        libraries=((IN_LIBRARY, None),),
        film=FilmPlan(frames=FRAMES, width=WIDTH, height=HEIGHT),
        overrides=COARSE,
    )


def put_film(plan: Plan, film_dir: Path) -> None:
    """A film that is there already, as the benchmark would have made it."""
    shutil.copytree(film_dir, plan.film_dir(ROOM))
    stamp = plan.film_plan(ROOM).stamp(default_library())
    (plan.film_dir(ROOM) / "film.json").write_text(json.dumps(stamp))


@pytest.fixture(scope="module")
def done(film, tmp_path_factory):  # noqa: F811
    """A finished benchmark: its plan, its rows, and what was said of its runs."""
    plan = plan_at(tmp_path_factory.mktemp("bench"))
    put_film(plan, film)
    said = []
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pipeline, "_draw", lambda scene, out_dir: None)
        rows = run_plan(plan, 0, lambda *what: said.append(what))
    return plan, rows, said


@pytest.fixture(scope="module")
def truth(film) -> TrueScene:  # noqa: F811
    return read_true_scene(film / "truth", 0.04)


def row(room="a", metric="m", value: float | None = 1.0, **other) -> Row:
    base = {"kind": "kitchen", "split": IN_LIBRARY, "seed": 1, "preset": "default"}
    base |= {"level": "medium", "truth_up_to": NONE, "stage": "mapping", "class_name": ""}
    return Row(room=room, metric=metric, value=value, **(base | other))


# ---------------------------------------------------------------------- the whole of it


def test_a_finished_benchmark_has_every_figure_of_every_run(done):
    _, rows, said = done
    assert [(e.run and e.run.name, d, t) for e, d, t in said] == [
        (None, 0, 2),
        ("default-perfect", 1, 2),
        ("default-truth-physical_check", 2, 2),
    ]
    assert all(ended.problem is None for ended, _, _ in said)
    means = means_of(rows)
    assert [key[3] for key in means.runs()] == [NONE, "physical_check"]
    of_truth = means.runs()[1]
    for figure in HEADLINE:
        needs_seconds = figure.title in ("PhyRecon", "MolmoSpaces, bodies")
        rooms = set() if needs_seconds else {ROOM.name}  # the tiny settings simulate half of one
        assert means.of(of_truth, figure).keys() == rooms, figure.title


def test_all_true_scores_as_it_must(done):
    """True labels, entities, supports, models and poses: nothing is left to lose."""
    _, rows, _ = done
    means = means_of(rows)
    key = next(k for k in means.runs() if k[3] == "physical_check")
    value = {figure.title: means.of(key, figure).get(ROOM.name) for figure in HEADLINE}
    for title in (
        "RQ",
        "instance AP@0.5",
        "box mAP@0.5",
        "box mAP_re@0.5",
        "support precision",
        "support recall",
        "proximal precision",
        "proximal recall",
        "retrieval top-1",
        "retrieval top-10",
        "Scan2CAD accuracy, official",
        "Scan2CAD accuracy, strict",
    ):
        assert value[title] == 1.0, title
    assert value["surface F at 5 cm"] > 0.97, "stuff has points in the true map, and no faces"
    assert value["PQ"] > 0.97 and value["functional equivalence"] > 0.98
    assert value["Chamfer, two-way"] < 0.003, "the export sets bodies down by less"
    assert value["runs that failed"] == 0.0


def test_classes_and_costs_are_rows_too(done):
    _, rows, _ = done
    whole = [r for r in rows if r.truth_up_to == NONE]
    pq = {r.class_name: r.value for r in whole if r.metric == "panoptic.classes.pq"}
    assert {"floor", "chair", "table"} <= pq.keys() and all(0 <= v <= 1 for v in pq.values())
    cost = {r.metric: r.value for r in whole if r.stage == "cost"}
    assert cost["seconds"] >= cost["seconds.mapping"] > 0 and cost["cpu_seconds"] > 0
    assert 1e8 < cost["peak_memory_bytes"] < 1e11
    assert {r.stage for r in whole} >= {"mapping", "entities", "contact_graph", "matching"}


def test_parquet_and_csv_hold_the_same_rows(done):
    plan, rows, _ = done
    assert BENCH.read(plan.out_dir) == rows
    with (plan.out_dir / BENCH.csv).open(newline="", encoding="utf-8") as file:
        told = list(csv.DictReader(file))
    assert list(told[0]) == list(BENCH.columns) and len(told) == len(rows)
    for line, kept in zip(told, rows, strict=True):
        assert float(line["value"]) == kept.value and int(line["seed"]) == kept.seed
        assert line["class"] == kept.class_name and line["metric"] == kept.metric


def test_a_second_call_runs_nothing(done):
    plan, rows, _ = done
    assert run_plan(plan, 0, lambda *what: pytest.fail(f"{what} was run again")) == rows


def test_another_setting_or_film_is_another_run(done):
    plan, _, _ = done
    libraries, run = Libraries(plan), plan.runs(ROOM)[0]
    finer = dataclasses.replace(plan, overrides=(*COARSE, "mapping.voxel_size_m=0.03"))
    longer = dataclasses.replace(plan, film=dataclasses.replace(plan.film, frames=FRAMES + 1))
    other = dataclasses.replace(run, level="weak")
    keys = [run_key(p, r, libraries) for p, r in ((plan, run), (finer, run), (longer, run))]
    assert len({*keys, run_key(plan, other, libraries)}) == 4
    assert kept_rows(plan.run_dir(run), keys[0]) is not None
    assert kept_rows(plan.run_dir(run), keys[1]) is None


def test_a_run_that_fails_is_a_row_and_the_others_stand(done, film, tmp_path, monkeypatch):  # noqa: F811
    plan, rows, _ = done
    mine = plan_at(tmp_path / "bench", presets=("default", "paper"), truths=())
    shutil.copytree(plan.out_dir / "rooms", mine.out_dir / "rooms")

    def broken(*_):
        raise ZeroDivisionError("no such room")

    monkeypatch.setattr(one_run, "_reconstruct", broken)
    found = run_plan(mine, 0, lambda *_: None)
    failed = [r for r in found if r.preset == "paper"]
    assert [(r.stage, r.metric, r.value) for r in failed] == [(RUN, FAILED, 1.0)]
    assert "ZeroDivisionError: no such room" in failed[0].note
    trace = mine.run_dir(mine.runs(ROOM)[1]) / "traceback.txt"
    assert str(trace) in failed[0].note and "in broken" in trace.read_text()
    assert [r for r in found if r.preset == "default"] == [r for r in rows if r.level == "perfect"]
    assert "no such room" in "".join(sheet.markdown() for sheet in sheets(found))
    assert sheets(found)[-1].title == "runs that failed"


def test_ctrl_c_keeps_what_is_done(done, tmp_path, monkeypatch):
    plan, rows, _ = done
    mine = plan_at(tmp_path / "bench", presets=("default", "paper"), truths=())
    shutil.copytree(plan.out_dir / "rooms", mine.out_dir / "rooms")

    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(one_run, "_reconstruct", stopped)
    with pytest.raises(KeyboardInterrupt):
        run_plan(mine, 0, lambda *_: None)
    assert BENCH.read(mine.out_dir) == [r for r in rows if r.level == "perfect"]


def test_a_room_that_cannot_be_filmed_fails_by_itself(tmp_path):
    plan = plan_at(tmp_path)
    plan.film_dir(ROOM).mkdir(parents=True)
    (plan.film_dir(ROOM) / "letters.txt").write_text("dear")
    rows = run_plan(plan, 0, lambda *_: None)
    assert [(r.metric, r.value) for r in rows] == [(FAILED, 1.0)] * 2
    assert all("was not filmed" in r.note and "holds something else" in r.note for r in rows)


class _Dead:
    exitcode = -9

    def join(self):
        pass


@pytest.mark.parametrize(
    ("filmed", "done_runs", "lost", "left"), [(True, 1, 1, 1), (False, 0, 3, 0)]
)
def test_a_process_that_dies_costs_one_run(tmp_path, filmed, done_runs, lost, left):
    plan = plan_at(tmp_path, truths=("mapping", "entities"))
    work = RoomWork(plan, ROOM, plan.runs(ROOM))
    busy = workers._Busy(_Dead(), None, work, filmed, done_runs)  # type: ignore[arg-type]
    ended, rest = workers._left_behind(busy)
    assert [e.run for e in ended] == list(work.runs[done_runs : done_runs + lost])
    assert all("exit -9" in (e.problem or "") for e in ended)
    assert [w.runs for w in rest] == [work.runs[done_runs + 1 :]] * left


@pytest.mark.slow
def test_processes_find_what_this_one_finds(done, film, tmp_path):  # noqa: F811
    _, rows, _ = done
    mine = plan_at(tmp_path, truths=())
    put_film(mine, film)
    found = run_plan(mine, 2, lambda *_: None)
    steady = [dataclasses.astuple(r) for r in rows if r.level == "perfect" and r.stage != "cost"]
    assert [dataclasses.astuple(r) for r in found if r.stage != "cost"] == steady


# ---------------------------------------------------------------------- the truth as a result


def test_the_true_scene_is_what_was_written(truth, film):  # noqa: F811
    scene = read_scene(film / "truth" / "scene.json")
    kept = {e.name for e in truth.scene.entities}
    assert kept <= {e.name for e in scene.entities} and len(kept) > 20
    names = [e.name for e in truth.entities]
    for i, record in enumerate(truth.scene.entities):
        parent = int(truth.graph.parent[i])
        assert (names[parent] if parent >= 0 else None) == (
            None if record.parent in (None, "room") else record.parent
        )
        assert truth.entities[i].name == record.name
        low, high = truth.entities[i].mesh.vertices.min(0), truth.entities[i].mesh.vertices.max(0)
        np.testing.assert_allclose((low + high)[2] / 2, record.box.center[2], atol=0.05)


def test_the_true_surface_has_one_instance_a_thing_and_one_a_class_of_all_else(truth):
    surface = truth.surface
    class_of = dict(zip(surface.instance_ids.tolist(), surface.class_ids.tolist(), strict=True))
    assert set(np.unique(surface.instance).tolist()) == set(class_of)
    things = {e.id for e in truth.entities if not e.is_layout}
    others = [c for i, c in class_of.items() if i not in things]
    assert len(others) == len(set(others)), "walls are one"
    assert len(things & set(class_of)) > 20
    assert surface.mesh.faces.max() < len(surface.mesh.vertices)


def test_the_true_shortlist_and_alignments_name_the_true_pose(truth):
    library = default_library()
    shortlist = true_shortlist(truth, library)
    aligned = true_alignments(truth, shortlist)
    cads = [e.cad for e in truth.scene.entities if e.cad is not None]
    assert [library[int(m)].id for m in shortlist.model] == [cad.id for cad in cads]
    for k, cad in enumerate(cads):
        yaw = float(aligned.yaw[k])
        c, s = np.cos(yaw), np.sin(yaw)
        turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ CUBE_ROTATIONS[shortlist.rotation[k]]
        upright = abs(cad.T_world_cad[2, 2]) > 0.999
        if upright:
            np.testing.assert_allclose(turn, cad.T_world_cad[:3, :3], atol=1e-5)
        box = truth.entities[int(shortlist.entity[k])].box
        apart = (yaw - float(box.yaw) + np.pi) % (2 * np.pi) - np.pi
        assert not upright or abs(apart) < 0.01, "rotations are taken in the entity's box"
    matched = shortlist.plane_match >= 0
    planes = [len(truth.entities[int(i)].planes.offset) for i in shortlist.entity]
    assert matched.sum() > 0.99 * sum(planes), "true planes are those of the true model"


def test_a_run_from_the_truth_of_matching_uses_the_rooms_own_models(tmp_path):
    plan = dataclasses.replace(plan_at(tmp_path), libraries=((IN_LIBRARY, None),))
    libraries = Libraries(plan)
    libraries._rooms = {IN_LIBRARY: object()}  # type: ignore[dict-item]
    own = [s for s in STAGES if libraries.of_run(Run(ROOM, "default", "", s)) is not libraries.kit]
    assert own == ["matching", "alignment", "physical_check"]
    assert libraries.of_run(Run(ROOM, "default", "perfect", MASKS)) is libraries.kit


# ---------------------------------------------------------------------- numbers


@dataclasses.dataclass(frozen=True)
class ByClass:
    class_name: str
    pq: float


@dataclasses.dataclass(frozen=True)
class ByThing:
    truth: str
    class_name: str
    error_m: float | None
    good: bool


@dataclasses.dataclass(frozen=True)
class ByLimit:
    limit_m: float
    recall: float


@dataclasses.dataclass(frozen=True)
class Made:
    panoptic: tuple[ByClass, ...]
    rows: tuple[ByThing, ...]
    rates: tuple[ByLimit, ...]
    ap: dict[str, float]
    by_name: dict[str, float]
    nothing: float | None
    text: str

    @property
    def half(self) -> float:
        return 0.5


def settled() -> StabilityReport:
    variants = VariantRates(1.0, None, 0.5)
    still = SetReport("as exported", (), (), (), 0.002, 0.001, 3, {}, 1.0, 5.0, None, variants, 0)
    return StabilityReport(
        "scene.xml", still, still, None, ResetReport(0, 0.002, 0, None), ("cup_1",), (), (), 0.01, 2
    )


def test_every_number_of_a_report_becomes_a_row():
    made = Made(
        panoptic=(ByClass("chair", 0.25), ByClass("table", 0.75)),
        rows=(
            ByThing("chair_1", "chair", 0.1, True),
            ByThing("chair_2", "chair", 0.3, False),
            ByThing("cup_1", "cup", None, False),
        ),
        rates=(ByLimit(0.01, 0.4), ByLimit(0.05, 0.9)),
        ap={"chair": 0.5},
        by_name={"chair_1": 0.2, "chair_2": 0.4},
        nothing=None,
        text="words",
    )
    found = {(v.stage, v.metric, v.class_name): v.value for v in flatten(made, settled())}  # type: ignore[arg-type]
    scored = {k: v for k, v in found.items() if k[0] != "stability"}
    assert scored == {
        ("mapping", "panoptic.pq", "chair"): 0.25,
        ("mapping", "panoptic.pq", "table"): 0.75,
        ("scene", "rows.count", ""): 3.0,
        ("scene", "rows.error_m.mean", ""): pytest.approx(0.2),  # of 0.1 and 0.3
        ("scene", "rows.error_m.max", ""): 0.3,
        ("scene", "rows.good.mean", ""): pytest.approx(1 / 3),
        ("scene", "rows.good.max", ""): 1.0,
        ("scene", "rates.0.01.recall", ""): 0.4,
        ("scene", "rates.0.05.recall", ""): 0.9,
        ("scene", "ap", "chair"): 0.5,
        ("scene", "by_name.count", ""): 2.0,
        ("scene", "by_name.mean", ""): pytest.approx(0.3),
        ("scene", "by_name.max", ""): 0.4,
        ("scene", "half", ""): 0.5,
    }
    assert found["stability", "exported.penetration_max_m", ""] == 0.002
    assert found["stability", "failed.count", ""] == 1.0
    assert ("stability", "exported.variants.molmospaces_bodies", "") not in found


def test_an_interval_of_two_rooms_is_known():
    """Two of {0, 1} drawn anew: means 0, 1/2 and 1 with chances 1/4, 1/2, 1/4."""
    interval = mean_interval([0.0, 1.0])
    assert interval is not None
    assert (interval.mean, interval.low, interval.high, interval.count) == (0.5, 0.0, 1.0, 2)


def test_an_interval_is_that_of_the_normal_for_many_rooms():
    values = np.random.default_rng(3).normal(2.0, 1.0, 400)
    interval = mean_interval(values.tolist())
    assert interval is not None and interval.low is not None and interval.high is not None
    half = 1.96 * values.std() / np.sqrt(400)
    assert interval.high - interval.mean == pytest.approx(half, rel=0.08)
    assert interval.mean - interval.low == pytest.approx(half, rel=0.08)
    assert mean_interval(values.tolist()) == interval, "seeded"


def test_an_interval_needs_rooms():
    assert mean_interval([]) is None
    one = mean_interval([0.3])
    assert one is not None and (one.mean, one.low, one.high) == (0.3, None, None)
    same = mean_interval([0.25, 0.25, 0.25])
    assert same is not None and (same.low, same.high) == (0.25, 0.25)


def test_paired_differences_ignore_how_hard_a_room_is():
    easy_and_hard = {"a": 0.9, "b": 0.1, "c": 0.5}
    better = {"a": 1.0, "b": 0.2, "d": 0.0}
    difference = paired_difference(better, easy_and_hard)  # rooms a and b: 0.1 each
    assert difference is not None and difference.count == 2
    assert difference.low == pytest.approx(0.1) and difference.high == pytest.approx(0.1)
    assert paired_difference({"a": 1.0}, {"b": 1.0}) is None


def test_printed_means_and_differences_are_those_of_the_rooms():
    values = {"default": (0.2, 0.4), "paper": (0.1, 0.2)}
    rows = [
        row(room, "panoptic.pq", v, preset=p)
        for p, both in values.items()
        for room, v in zip("ab", both, strict=True)
    ]
    rows += [row(room, "panoptic.pq", 0.9, level="perfect", truth_up_to=MASKS) for room in "ab"]
    means, differences, truths = sheets(rows)
    assert means.title == "in-library, masks medium, 2 rooms"
    assert means.lines == (("PQ, %", "30.0 [20.0, 40.0]", "15.0 [10.0, 20.0]"),)
    assert differences.headings[1] == "paper - default"
    assert differences.lines == (("PQ, %", "-15.0 [-20.0, -10.0]"),)  # -10 and -20
    assert truths.headings == ("", "end to end, medium", MASKS)
    assert truths.lines == (("PQ, %", "30.0", "90.0"),)


def test_markdown_has_every_sheet(tmp_path):
    found = sheets([row("a", "panoptic.pq", 0.5), row("b", "panoptic.pq", 0.7)])
    write_markdown(found, tmp_path / "bench.md")
    text = (tmp_path / "bench.md").read_text()
    assert "| PQ, % | 60.0 [50.0, 70.0] |" in text and "| --- | ---: |" in text


def test_a_table_without_values_keeps_its_columns(tmp_path):
    rows = [row(value=None, note="why"), row(value=0.1 + 0.2, class_name="chair")]
    BENCH.write(rows, tmp_path)
    assert BENCH.read(tmp_path) == rows
    lines = (tmp_path / BENCH.csv).read_text().splitlines()
    assert lines[0] == ",".join(BENCH.columns) and lines[2].endswith("chair,0.30000000000000004,")
    BENCH.write([], tmp_path)
    assert BENCH.read(tmp_path) == []


def test_costs_are_counted_by_stage(monkeypatch):
    clock = iter([0.0, 1.0, 3.0, 7.0, 10.0])  # start, mapping, entities, mapping again, end
    monkeypatch.setattr("experiments.bench.cost.time.perf_counter", lambda: next(clock, 10.0))
    recorder = Recorder()
    meter = CostMeter(recorder)
    for name in ("mapping", "entities", "mapping"):
        meter.stage(name, False)
    costs = meter.costs()
    assert costs["seconds"] == 10.0 and costs["seconds.mapping"] == 2.0 + 3.0
    assert costs["seconds.entities"] == 4.0 and recorder.reused == {
        "mapping": False,
        "entities": False,
    }


# ---------------------------------------------------------------------- rooms, libraries, command


def test_kinds_take_turns_in_each_split():
    specs = room_specs(("in-library", "held-out"), 12, 100)
    assert [s.seed for s in specs] == [*range(100, 112, 2), *range(101, 112, 2)]
    assert specs[0].kind == specs[5].kind and len({s.kind for s in specs[:5]}) == 5
    assert [s.kind for s in specs[:6]] == [s.kind for s in specs[6:]]
    with pytest.raises(SettingError, match="at least one per split"):
        room_specs(("in-library", "held-out"), 1, 100)


@pytest.mark.parametrize(
    "change",
    [
        {"presets": ("best",)},
        {"presets": ()},
        {"levels": ("hopeless",)},
        {"truths": ("export",)},
        {"overrides": ("mapping.voxel_size_m=-1",)},
    ],
)
def test_a_plan_that_cannot_be_run_is_refused(change, tmp_path):
    with pytest.raises(SettingError):
        dataclasses.replace(plan_at(tmp_path), **change)


def test_the_figures_of_a_room_come_from_its_truth(done):
    plan, _, _ = done
    sheet = room_sheet(plan.out_dir)
    assert sheet.lines[0][0] == ROOM.name and sheet.lines[-1][0] == "mean"
    assert sheet.lines[0][1:] == sheet.lines[-1][1:], "the mean of one room"
    columns = dict(zip(sheet.headings, sheet.lines[0], strict=True))
    room = json.loads((plan.film_dir(ROOM) / "truth" / "room.json").read_text())
    assert int(columns["objects"]) == sum(i["kind"] == "thing" for i in room["items"])
    assert 0 < int(columns["seen, %"]) <= 100 and 0 < int(columns["occluded, %"]) < 100
    assert columns["taken away"] == "0" and columns["drift, mm"] == "-", "it was not settled"


def test_the_drift_of_a_room_that_was_settled_is_shown(tmp_path):
    truth = tmp_path / "rooms" / "in-library-office-1" / "film" / "truth"
    (truth / "twin").mkdir(parents=True)
    item = {"name": "cup_2", "kind": "thing", "class": "cup", "joints": [], "parent": None}
    notes = ["cup_3 taken away: moved 12.0 mm", "the library has nothing for: rug"]
    room = {"items": [item], "size_m": [4.0, 3.0, 2.5], "notes": notes}
    views = {"room": {"occlusion": 0.25, "seen": 0.5, "well_seen": None}}
    bodies = [{"drift_end_m": 0.0012}, {"drift_end_m": 0.0034}]
    (truth / "room.json").write_text(json.dumps(room))
    (truth / "views.json").write_text(json.dumps(views))
    twin = {"exported": {"bodies": bodies}}
    (truth / "twin" / "stability.json").write_text(json.dumps(twin))
    (line, mean) = room_sheet(tmp_path).lines
    assert line[1:] == mean[1:] == ("12", "1", "1", "0", "0", "25", "50", "-", "1", "3.4")


def test_rooms_that_are_not_there_are_an_error(tmp_path):
    with pytest.raises(SceneError, match="no film below"):
        room_sheet(tmp_path)


def test_a_library_is_taken_as_it_is_and_furniture_is_imported_once(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    ours = tmp_path / "ours"
    (ours / "chair" / "plain").mkdir(parents=True)
    (ours / "chair" / "plain" / "model.json").write_text("{}")
    recorder, calls = Recorder(), []
    assert held_out.held_out_library(ours, recorder) == ours and not recorder.notes

    def importing(source, library, progress):
        calls.append(source)
        library.mkdir(parents=True)
        return dataclasses.make_dataclass("Report", ["accepted"])(("chair/plain",))

    monkeypatch.setattr("isr_jax.cad.importing.add.add_models", importing)
    furniture = tmp_path / "furniture"
    furniture.mkdir()
    (furniture / "chair.obj").write_text("v 0 0 0")
    first = held_out.held_out_library(furniture, recorder)
    assert held_out.held_out_library(furniture, recorder) == first and calls == [furniture]
    assert first is not None and first.is_relative_to(tmp_path / "cache")
    (furniture / "table.obj").write_text("v 0 0 0")
    assert held_out.held_out_library(furniture, recorder) != first, "a newer package"
    with pytest.raises(LibraryError, match="sweethome3d-furniture"):
        held_out.held_out_library(tmp_path / "nowhere", recorder)


def test_a_split_without_its_library_is_skipped_and_says_how_to_get_it(
    tmp_path, monkeypatch, capsys
):
    monkeypatch.setattr(held_out, "PACKAGE", tmp_path / "nowhere")
    with pytest.raises(SystemExit) as stop:
        command.main(["--out", str(tmp_path / "b"), "--splits", "held-out"])
    told = " ".join("".join(capsys.readouterr()).split())
    assert stop.value.code == 2 and "held-out skipped" in told
    assert "sweethome3d-furniture" in told and "isr cad add" in told


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("tables", "--out", "{out}"), "bench.parquet"),
        (("rooms", "--out", "{out}"), "no film below"),
        (("--out", "{out}", "--rooms", "0"), "0 rooms"),
        (("--out", "{out}", "--splits", "other"), "in-library, held-out"),
        (("--out", "{out}", "--size", "big"), "640x480"),
        (("--out", "{out}", "--presets", "best", "--splits", "in-library"), "voxblox++"),
    ],
)
def test_a_user_error_is_one_message_and_status_2(arguments, says, tmp_path, capsys):
    with pytest.raises(SystemExit) as stop:
        command.main([a.format(out=tmp_path) for a in arguments])
    err = "".join(capsys.readouterr().err.split())  # the console wraps where it likes
    assert stop.value.code == 2 and err.startswith("error:") and "".join(says.split()) in err, err


def test_without_pyarrow_nothing_is_run(tmp_path, monkeypatch):
    import sys

    monkeypatch.setitem(sys.modules, "pyarrow", None)
    with pytest.raises(OutputError, match=r"isr_jax\[bench\]"):
        command.Bench(out=tmp_path).run(None)  # type: ignore[arg-type]


def test_help_teaches(capsys):
    for arguments in (["--help"], ["tables", "--help"], ["rooms", "--help"]):
        with pytest.raises(SystemExit):
            command.main(arguments)
        assert "Example: python -m experiments.bench" in capsys.readouterr().out


def test_tables_print_again_without_running(done, capsys):
    plan, rows, _ = done
    command.main(["tables", "--out", str(plan.out_dir)])
    told = capsys.readouterr().out
    assert "in-library, masks perfect, 1 rooms" in told and f"{len(rows)} values" in told
    assert (plan.out_dir / BENCH.parquet).name in told
