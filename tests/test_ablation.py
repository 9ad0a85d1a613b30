"""The ablation: variants differ in what they say, scores are the benchmark's, runs resume."""

from __future__ import annotations

import dataclasses
import itertools
import json
import shutil
from pathlib import Path
from types import SimpleNamespace

import jax.numpy as jnp
import numpy as np
import pytest

from experiments.ablation import __main__ as command
from experiments.ablation import map_run
from experiments.ablation.diagnose import KINDS, losses, surplus
from experiments.ablation.kept_segments import kept_segments
from experiments.ablation.map_film import MaskedFilm, map_film
from experiments.ablation.map_run import LOSS, TABLE, MapRow, kept_values, run_key
from experiments.ablation.plan import AblationPlan, MapRun
from experiments.ablation.pq_gain import gain_if_found, gain_without
from experiments.ablation.report import FIGURES, sheets
from experiments.ablation.run_ablation import run_plan
from experiments.ablation.scores import judge, truth_of
from experiments.ablation.variants import (
    ABLATED,
    GROUPS,
    OURS_WITHOUT,
    PAPER_WITHOUT,
    PRESET_GROUP,
    STEPS,
    VARIANTS,
    chosen,
    variant,
)
from experiments.bench.one_run import COST, FAILED, RUN
from experiments.bench.plan import IN_LIBRARY, RoomSpec
from experiments.bench.rows import scored
from experiments.bench.workers import NO_FILM
from isr_jax import evaluation
from isr_jax.cad import default_library
from isr_jax.classes import class_named, classes
from isr_jax.config import PRESETS, Settings, preset
from isr_jax.demonstration.film import FilmPlan
from isr_jax.errors import SequenceError, SettingError
from isr_jax.evaluation.maps.panoptic import panoptic_quality
from isr_jax.evaluation.maps.segments import Comparison, Segments
from isr_jax.types import FrameSegments

from .films import COARSE, FRAMES, HEIGHT, WIDTH, coarse, film, finished  # noqa: F401 (fixtures)

ROOM = RoomSpec(IN_LIBRARY, "kitchen", 100)
LEVEL = "perfect"


def plan_at(folder: Path, films: Path | None = None, variants=("default",)) -> AblationPlan:
    """One tiny room with true masks."""
    return AblationPlan(
        out_dir=folder,
        rooms=(ROOM,),
        variants=variants,
        level=LEVEL,
        preset_levels=(),
        film=FilmPlan(frames=FRAMES, width=WIDTH, height=HEIGHT),
        films=films,
        libraries=((IN_LIBRARY, None),),
        overrides=COARSE,
    )


@pytest.fixture(scope="module")
def films(film, tmp_path_factory) -> Path:  # noqa: F811
    """A folder of the benchmark in which the room is filmed."""
    folder = tmp_path_factory.mktemp("bench")
    plan = plan_at(folder)
    shutil.copytree(film, plan.room_dir(ROOM) / "film")
    stamp = plan.film_plan(ROOM).stamp(default_library())
    (plan.room_dir(ROOM) / "film" / "film.json").write_text(json.dumps(stamp))
    return folder


@pytest.fixture(scope="module")
def done(films, tmp_path_factory):
    """A finished ablation: its plan, its rows, and what was said."""
    plan = plan_at(tmp_path_factory.mktemp("ablation"), films, ("default", "voxblox++"))
    said = []
    rows = run_plan(plan, 0, lambda *what: said.append(what))
    return plan, rows, said


# ---------------------------------------------------------------------- the table of variants


def different(a: Settings, b: Settings) -> set[str]:
    """Settings that differ, as section.name."""
    return {
        f"{section.name}.{field.name}"
        for section in dataclasses.fields(a)
        if section.name != "preset"
        for field in dataclasses.fields(getattr(a, section.name))
        if getattr(getattr(a, section.name), field.name)
        != getattr(getattr(b, section.name), field.name)
    }


def ablated(a: str, b: str) -> set[str]:
    """What two presets differ in, of what the ablation is about."""
    found = different(preset(a), preset(b))
    return {name for name in found if name.split(".")[0] in ABLATED}


@pytest.mark.parametrize("one", VARIANTS, ids=lambda v: v.name)
def test_a_variant_differs_from_its_base_in_exactly_what_it_says(one):
    base = variant(one.base).settings()
    assert different(one.settings(), base) == set(one.changed)
    assert len(set(one.changed)) == len(one.changed)
    assert bool(one.changes) == (one.group != PRESET_GROUP) and one.shows


def test_steps_lead_from_the_baseline_to_the_paper():
    steps = chosen((STEPS,))
    assert [v.base for v in steps] == ["voxblox++", *(v.name for v in steps[:-1])]
    assert not different(steps[-1].settings(), preset("paper"))


@pytest.mark.parametrize(
    ("group", "of", "other"),
    [(PAPER_WITHOUT, "paper", "voxblox++"), (OURS_WITHOUT, "default", "paper")],
)
def test_all_that_presets_differ_in_is_taken_away_once(group, of, other):
    changes = [name for v in chosen((group,)) for name in v.changes]
    assert len(changes) == len(set(changes)) and set(changes) == ablated(of, other)
    assert all((v.base, v.source) == (of, other) for v in chosen((group,)))


def test_variants_are_chosen_by_name_and_by_group():
    assert [v.name for v in chosen(("paper", "default"))] == ["default", "paper"]
    assert {v.name for v in chosen((PRESET_GROUP,))} == set(PRESETS)
    assert len(chosen(tuple(GROUPS))) == len(VARIANTS) == len({v.name for v in VARIANTS})
    with pytest.raises(SettingError, match=r"voxblox\+\+"):
        chosen(("best",))


def test_changes_of_a_call_are_made_to_every_variant_and_leave_it_its_own():
    coarser = ("mapping.voxel_size_m=0.05", "segmentation.bilateral=false")
    settings = variant("+ bilateral").settings(coarser)
    assert settings.mapping.voxel_size_m == 0.05 and settings.segmentation.bilateral
    assert variant("default, 2 cm voxels").settings(coarser).mapping.voxel_size_m == 0.02


# ---------------------------------------------------------------------- runs


def test_scores_are_those_of_the_benchmark(done, finished):  # noqa: F811
    """The finished run went through files; here all stays in memory."""
    plan, _, _ = done
    folder = plan.film_dir(ROOM)
    report = evaluation.evaluate(finished.out_dir, folder / "truth")
    parts = ("panoptic", "instances", "boxes", "observed_boxes")
    theirs = [v for v in scored(report) if v.metric.split(".")[0] in parts]
    ours = [v for v in kept_values(plan, plan.runs(ROOM)[0]) or () if v.stage not in (COST, LOSS)]
    assert len(ours) > 100 and {v.class_name for v in ours} >= {"", "chair", "floor"}
    key = dataclasses.astuple
    assert sorted(map(key, ours)) == sorted(map(key, theirs))


def test_every_run_has_every_figure(done):
    _, rows, said = done
    names = [None, f"default, {LEVEL}", f"voxblox++, {LEVEL}"]
    assert [(e.run and e.run.name, d, t) for e, d, t in said] == [
        (name, k, 2) for k, name in enumerate(names)
    ]
    assert all(ended.problem is None for ended, _, _ in said)
    for name in ("default", "voxblox++"):
        of = {(r.stage, r.metric) for r in rows if r.variant == name and not r.class_name}
        assert of >= {(f.stage, f.metric) for f in FIGURES} | {(RUN, FAILED)}
        lost = sum(r.value for r in rows if r.variant == name and r.metric.endswith(".count"))
        assert lost > 20, "true segments"
    assert TABLE.columns[:5] == ("room", "kind", "split", "seed", "variant")
    assert "class" in TABLE.columns


def test_nothing_is_written_where_the_films_are(done, films):
    assert {p.name for p in (films / "rooms" / ROOM.name).iterdir()} == {"film"}
    plan, rows, _ = done
    assert TABLE.read(plan.out_dir) == rows


def test_a_second_call_maps_nothing(done, monkeypatch):
    plan, rows, _ = done
    monkeypatch.setattr(map_run, "map_film", lambda *_: pytest.fail("mapped again"))
    assert run_plan(plan, 0, lambda *what: pytest.fail(f"{what} was run again")) == rows


def test_runs_with_the_same_settings_share_their_values(done, monkeypatch):
    """The last step is the preset ``paper``, whatever it is called."""
    plan, _, _ = done
    paper, last = MapRun(ROOM, "paper", LEVEL), MapRun(ROOM, chosen((STEPS,))[-1].name, LEVEL)
    assert run_key(plan, paper) == run_key(plan, last)
    assert run_key(plan, dataclasses.replace(paper, level="weak")) != run_key(plan, paper)
    names = {v.name: run_key(plan, MapRun(ROOM, v.name, LEVEL)) for v in VARIANTS}
    for a, b in itertools.combinations(names, 2):
        sections = {
            name.split(".")[0] for name in different(variant(a).settings(), variant(b).settings())
        }
        assert (names[a] != names[b]) == bool(sections & {*ABLATED, "contact_graph"}), (a, b)
    mine = dataclasses.replace(plan, variants=("paper", last.variant))
    mapped = []
    monkeypatch.setattr(map_run, "_values", lambda _, run: mapped.append(run) or [])
    monkeypatch.setattr(map_run, "code_digest", lambda parts: "other code")
    rows = run_plan(mine, 0, lambda *_: None)
    assert mapped == [paper] and [r.variant for r in rows] == ["paper", last.variant]


def test_another_code_is_another_run(done, monkeypatch):
    plan, _, _ = done
    run = plan.runs(ROOM)[0]
    before = run_key(plan, run)
    monkeypatch.setattr(map_run, "code_digest", lambda parts: "edited")
    assert run_key(plan, run) != before


def test_a_run_that_fails_is_a_row_and_ctrl_c_keeps_what_is_done(done, monkeypatch):
    plan, rows, _ = done
    mine = dataclasses.replace(plan, variants=("default", "paper"))
    kept = [r for r in rows if r.variant == "default"]

    def broken(*_):
        raise ZeroDivisionError("no such map")

    monkeypatch.setattr(map_run, "map_film", broken)
    found = run_plan(mine, 0, lambda *_: None)
    (failed,) = [r for r in found if r.variant == "paper"]
    assert (failed.stage, failed.metric, failed.value) == (RUN, FAILED, 1.0)
    assert "ZeroDivisionError: no such map" in failed.note and ".traceback.txt" in failed.note
    assert [r for r in found if r.variant == "default"] == kept
    assert sheets(found)[-1].title == "runs that failed"

    def stopped(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(map_run, "map_film", stopped)
    with pytest.raises(KeyboardInterrupt):
        run_plan(mine, 0, lambda *_: None)
    assert TABLE.read(mine.out_dir) == kept


def test_another_film_is_not_taken(done, tmp_path):
    plan, _, _ = done
    longer = dataclasses.replace(plan.film, frames=FRAMES + 1)
    assert plan.given_film(ROOM) is not None
    assert dataclasses.replace(plan, film=longer).given_film(ROOM) is None
    assert dataclasses.replace(plan, films=tmp_path).given_film(ROOM) is None
    with pytest.raises(SequenceError, match="no finished film"):
        _ = MaskedFilm(tmp_path, LEVEL, tmp_path).stamp


def test_a_room_that_cannot_be_filmed_fails_by_itself(tmp_path):
    plan = plan_at(tmp_path)
    plan.film_dir(ROOM).mkdir(parents=True)
    (plan.film_dir(ROOM) / "letters.txt").write_text("dear")
    rows = run_plan(plan, 0, lambda *_: None)
    assert [(r.metric, r.value) for r in rows] == [(FAILED, 1.0)]
    assert NO_FILM in rows[0].note and "holds something else" in rows[0].note


# ---------------------------------------------------------------------- kept segments


def test_kept_segments_are_those_that_were_made(tmp_path):
    rng = np.random.default_rng(0)
    made = [
        FrameSegments(
            rng.integers(0, top, (12, 16)).astype(np.int32),
            rng.integers(0, 5, top).astype(np.int32),
            rng.integers(0, 300, top).astype(np.int32),
        )
        for top in (3, 300)
    ]
    path = tmp_path / "deep" / "segments.npz"
    first = kept_segments(path, lambda: iter(made))
    again = kept_segments(path, lambda: pytest.fail("made again"))
    for index, frame in enumerate(made):
        for found in (first[index], again[index]):
            for name, values in vars(frame).items():
                kept = getattr(found, name)
                np.testing.assert_array_equal(kept, values)
                assert kept.dtype == np.int32
    assert [p.name for p in path.parent.iterdir()] == ["segments.npz"]


def test_segments_are_kept_by_what_they_depend_on(done, tmp_path):
    plan, _, _ = done
    film = plan.masked_film(plan.runs(ROOM)[0])  # noqa: F811
    settings = coarse()
    paths = {
        film.segments_path(settings),
        film.segments_path(coarse("segmentation.bilateral=false")),
        film.segments_path(coarse("input.stride=2")),
        dataclasses.replace(film, level="weak").segments_path(settings),
    }
    assert len(paths) == 4
    assert film.segments_path(coarse("mapping.carve=false")) in paths
    made = sorted(p.name for p in film.segments_dir.iterdir())
    expected = [film.segments_path(plan.settings(run)).name for run in plan.runs(ROOM)]
    assert made == sorted(set(expected))


# ---------------------------------------------------------------------- the diagnosis

CHAIR, TABLE_CLASS, WALL = (class_named(n).id for n in ("chair", "table", "wall"))


def comparison(true: list[tuple[int, int]], predicted: list[tuple[int, int, int]], shared):
    """Segments of (id, class), those of the map with so many points off all truth."""
    ids, kinds = (np.array(v, np.int64) for v in zip(*true))
    found_ids, found_kinds, false = (np.array(v, np.int64) for v in zip(*predicted))
    shared = np.array(shared, np.int64)
    loose = np.array([row.sum() for row in shared])
    sizes = np.maximum(loose, 100), shared.sum(0) + false
    quality = panoptic_quality(
        *(jnp.asarray(v, jnp.int32) for v in (shared, *sizes, kinds, found_kinds)),
        class_count=len(classes()),
    )
    none = np.zeros(0, np.int64)
    return Comparison(
        Segments(none, ids, kinds), Segments(none, found_ids, found_kinds), shared, *sizes, quality
    )


def judged(compared: Comparison, before: Comparison | None = None):
    scene = SimpleNamespace(entities=())
    mapped = SimpleNamespace(entities=())
    truth = SimpleNamespace(scene=scene)
    return SimpleNamespace(truth=truth, mapped=mapped, compared=compared, before=before or compared)


@pytest.mark.parametrize(
    ("kind", "predicted", "shared"),
    [
        ("found", [(7, CHAIR, 0)], [[80]]),
        ("wrong class", [(7, TABLE_CLASS, 0)], [[80]]),
        ("split", [(7, CHAIR, 0), (8, CHAIR, 0)], [[45, 45]]),
        ("trimmed", [(7, CHAIR, 0)], [[40]]),
        ("spilled", [(7, CHAIR, 300)], [[90]]),
        ("in stuff", [(-WALL, WALL, 100)], [[60]]),
        ("missed", [(7, CHAIR, 0)], [[5]]),
    ],
)
def test_a_true_chair_is_lost_in_ways_that_have_names(kind, predicted, shared):
    (loss,) = losses(judged(comparison([(1, CHAIR)], predicted, shared)))  # type: ignore[arg-type]
    assert loss.kind == kind and loss.kind in KINDS and loss.seen == 100
    assert loss.pieces == {"split": 2, "spilled": 0, "in stuff": 0, "missed": 0}.get(kind, 1)


def test_a_chair_that_lies_in_a_larger_one_is_merged():
    compared = comparison([(1, CHAIR), (2, CHAIR)], [(7, CHAIR, 0)], [[30], [100]])
    found = {loss.name: loss for loss in losses(judged(compared))}  # type: ignore[arg-type]
    assert found["chair #1"].kind == "merged" and found["chair #2"].kind == "found"
    assert found["chair #1"].detail == "30% chair #7 (with chair #2), 70% nothing"


def test_what_entities_lost_is_dropped():
    before = comparison([(1, CHAIR)], [(7, CHAIR, 0)], [[80]])
    after = comparison([(1, CHAIR)], [(8, CHAIR, 100)], [[0]])
    (loss,) = losses(judged(after, before))  # type: ignore[arg-type]
    assert (loss.kind, loss.best, loss.iou) == ("dropped", "", 0.0)
    (extra,) = surplus(judged(after))  # type: ignore[arg-type]
    assert (extra.name, extra.points, extra.detail) == ("chair #8", 100, "false surface")


def mean_pq(compared: Comparison) -> float:
    quality = compared.quality
    occurs = quality.true_positives + quality.false_positives + quality.false_negatives > 0
    return float(np.mean(np.asarray(quality.pq)[np.asarray(occurs)]))


def test_the_price_of_a_mistake_is_what_mending_it_gains():
    true = [(1, CHAIR), (2, CHAIR), (3, TABLE_CLASS)]
    predicted = [(7, CHAIR, 0), (8, TABLE_CLASS, 0), (9, CHAIR, 40)]
    compared = comparison(true, predicted, [[70, 0, 0], [0, 90, 0], [0, 0, 0]])
    sharper = comparison(true, predicted, [[100, 0, 0], [0, 90, 0], [0, 0, 0]])
    renamed = [(7, CHAIR, 0), (8, CHAIR, 0), (9, CHAIR, 40)]
    named = comparison(true, renamed, [[70, 0, 0], [0, 100, 0], [0, 0, 0]])
    fewer = comparison(true, predicted[:2], [[70, 0], [0, 90], [0, 0]])
    base = mean_pq(compared)
    assert gain_if_found(compared, 0) == pytest.approx(mean_pq(sharper) - base, abs=1e-6)
    assert gain_if_found(compared, 1) == pytest.approx(mean_pq(named) - base, abs=1e-6)
    assert gain_without(compared, 2) == pytest.approx(mean_pq(fewer) - base, abs=1e-6)


def test_a_diagnosis_of_a_film_names_its_things(done):
    plan, rows, _ = done
    run = plan.runs(ROOM)[0]
    mapped = map_film(plan.masked_film(run), plan.settings(run))
    found = losses(judge(mapped, truth_of(plan.film_dir(ROOM))))
    assert {loss.kind for loss in found} <= set(KINDS) and "#" not in "".join(x.name for x in found)
    assert [x.pq_lost for x in found] == sorted((x.pq_lost for x in found), reverse=True)
    counts = {r.metric: r.value for r in rows if r.variant == "default" and r.stage == LOSS}
    assert counts["found.count"] == sum(loss.kind == "found" for loss in found) > 0


# ---------------------------------------------------------------------- tables and the command


def row(room: str, name: str, value: float, level: str = "medium", **other) -> MapRow:
    base = {"stage": "mapping", "metric": "panoptic.pq", "class_name": ""} | other
    return MapRow(room, "kitchen", IN_LIBRARY, 1, name, level, value=value, **base)


def test_variants_are_printed_beside_their_base_with_paired_differences():
    names = ("voxblox++", "+ triplets", "+ bilateral")
    rows = [
        row(room, name, base + 0.1 * k)
        for room, base in (("a", 0.1), ("b", 0.3))
        for k, name in enumerate(names)
    ]
    found = sheets(rows)
    _, steps, differences, _ = found
    assert [line[:2] for line in steps.lines] == [
        ("voxblox++", "20.0 [10.0, 30.0]"),
        ("+ triplets", "30.0 [20.0, 40.0]"),
        ("+ bilateral", "40.0 [30.0, 50.0]"),
    ]
    assert [line[:2] for line in differences.lines] == [
        ("+ triplets minus voxblox++", "+10.0 [10.0, 10.0]"),
        ("+ bilateral minus + triplets", "+10.0 [10.0, 10.0]"),
    ]


def test_levels_have_a_table_of_their_own():
    rows = [row("a", n, 0.5, level) for level in ("medium", "weak") for n in ("default", "paper")]
    (levels,) = [s for s in sheets(rows) if s.title.startswith("the presets and how wrong")]
    assert [line[:2] for line in levels.lines] == [
        ("default, medium", "50.0"),
        ("paper, medium", "50.0"),
        ("default, weak", "50.0"),
        ("paper, weak", "50.0"),
    ]


def test_presets_are_also_run_with_other_masks(tmp_path):
    plan = dataclasses.replace(
        plan_at(tmp_path, variants=("paper - outliers", "paper")), preset_levels=("weak", LEVEL)
    )
    assert [(run.variant, run.level) for run in plan.runs(ROOM)] == [
        ("paper", LEVEL),
        ("paper - outliers", LEVEL),
        *((name, "weak") for name in PRESETS),
        *((name, LEVEL) for name in PRESETS if name != "paper"),
    ]


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("tables", "--out", "{out}"), "ablation.parquet"),
        (("diagnose", "--film", "{out}", "--out", "{out}"), "no known sequence"),
        (("--out", "{out}", "--splits", "other"), "in-library, held-out"),
        (("--out", "{out}", "--level", "worst"), "strong, medium"),
        (("--out", "{out}", "--variants", "best"), "unknown variant"),
        (("--out", "{out}", "--set", "mapping.nothing=1"), "unknown setting"),
    ],
)
def test_a_user_error_is_one_message_and_status_2(arguments, says, tmp_path, capsys):
    with pytest.raises(SystemExit) as stop:
        command.main([a.format(out=tmp_path) for a in arguments])
    err = "".join(capsys.readouterr().err.split())  # the console wraps where it likes
    assert stop.value.code == 2 and err.startswith("error:") and "".join(says.split()) in err, err


def test_the_commands_print(done, capsys):
    plan, _, _ = done
    rows = run_plan(plan, 0, lambda *_: None)
    command.main(["tables", "--out", str(plan.out_dir)])
    told = capsys.readouterr().out
    assert "default minus voxblox++" in told and f"{len(rows)} values" in told
    assert "PQ lost, by what became" in told and (plan.out_dir / "ablation.md").is_file()
    command.main(["variants"])
    assert "paper - outliers" in capsys.readouterr().out
    folder, out = str(plan.film_dir(ROOM)), str(plan.out_dir)
    command.main(["diagnose", "--film", folder, "--level", LEVEL, "--out", out, "--set", *COARSE])
    told = capsys.readouterr().out
    assert "kinds of loss" in told and "chair_" in told


def test_help_teaches(capsys):
    for arguments in (
        ["--help"],
        *([name, "--help"] for name in ("tables", "variants", "diagnose")),
    ):
        with pytest.raises(SystemExit):
            command.main(arguments)
        assert "Example: python -m experiments.ablation" in capsys.readouterr().out
