"""Reuse of stage results: what matches is taken, what differs is named, what was killed resumes."""

from __future__ import annotations

import functools

import numpy as np
import pytest

from isr_jax.config import preset, with_overrides
from isr_jax.errors import SettingError
from isr_jax.runtime.stage import Stage
from isr_jax.runtime.stage_runner import STAGES, StageRunner
from isr_jax.runtime.store import StageStore


class Recorder:
    """A reporter that remembers which stages were reused."""

    def __init__(self):
        self.reused: dict[str, bool] = {}

    def stage(self, name, reused):
        self.reused[name] = reused

    def progress(self, name, done, total): ...

    def note(self, text): ...


def stage(name, version=1):
    return Stage(name, version, tuple, (name,))


def settings_of(entity_seed, map_seed):
    changes = [f"entities.seed={entity_seed}", f"mapping.min_votes={map_seed}"]
    return with_overrides(preset("default"), changes)


def count_up(frames, settings):
    return [(np.arange(3) * settings.min_votes,) for _ in frames]


def times_seed(maps, settings):
    return [(one[0] * settings.seed,) for one in maps]


def plus_one(entities, settings):
    return [(one[0] + 1,) for one in entities]


def chain(root, *, start_from=None, entity_setting=1, map_setting=1):
    """Three stages that read each other, as the pipeline's do."""
    recorder = Recorder()
    runner = StageRunner(StageStore(root), recorder, start_from)
    run = functools.partial(runner.run, settings_of(entity_setting, map_setting))
    mapped = run(stage("mapping"), count_up, ["a"])
    found = run(stage("entities"), times_seed, mapped)
    (graph,) = run(stage("contact_graph"), plus_one, found)
    return graph[0], recorder.reused


def test_a_second_run_reuses_everything(tmp_path):
    first, reused = chain(tmp_path)
    assert not any(reused.values())
    second, reused = chain(tmp_path)
    assert all(reused.values())
    np.testing.assert_array_equal(first, second)


def test_a_changed_setting_recomputes_from_there_on(tmp_path):
    chain(tmp_path)
    result, reused = chain(tmp_path, entity_setting=2)
    assert reused == {"mapping": True, "entities": False, "contact_graph": False}
    np.testing.assert_array_equal(result, [1, 3, 5])


def test_from_recomputes_that_stage_and_all_after_it(tmp_path):
    chain(tmp_path)
    _, reused = chain(tmp_path, start_from="entities")
    assert reused == {"mapping": True, "entities": False, "contact_graph": False}


def test_from_names_the_setting_that_differs(tmp_path):
    chain(tmp_path)
    with pytest.raises(SettingError, match=r"(?s)mapping.*min_votes"):
        chain(tmp_path, start_from="entities", map_setting=2)


def test_from_without_an_earlier_run_says_so(tmp_path):
    with pytest.raises(SettingError, match="stored result of mapping"):
        chain(tmp_path, start_from="entities")


def test_an_unknown_stage_names_the_known_ones(tmp_path):
    with pytest.raises(SettingError, match=", ".join(STAGES)):
        StageRunner(StageStore(tmp_path), start_from="fusing")


class Killed(Exception):
    pass


def count_to_ten(root, die_at=None, key="a"):
    """A stage that adds 1..10, keeping a checkpoint every 2 steps."""
    runner, steps = StageRunner(StageStore(root), Recorder()), []

    def compute(frames, settings):
        found = runner.resume("mapping")
        total, start = 0, 0
        if found:
            path, state = found
            total, start = int(np.load(path)["total"]), state["done"]
        for done in range(start + 1, 11):
            if done == die_at:
                raise Killed
            total += done
            steps.append(done)
            if done % 2 == 0:
                runner.checkpoint(
                    "mapping", functools.partial(np.savez, total=total), {"done": done}
                )
        return [(np.array(total),)]

    (result,) = runner.run(preset("default"), stage("mapping"), compute, [key])
    return int(result[0]), steps


def test_a_killed_stage_resumes_after_its_checkpoint(tmp_path):
    with pytest.raises(Killed):
        count_to_ten(tmp_path, die_at=8)
    total, steps = count_to_ten(tmp_path)
    assert total == 55 and steps == [7, 8, 9, 10]
    assert not list(tmp_path.glob("*checkpoint*")), "a finished stage leaves no checkpoint behind"


def test_a_checkpoint_of_other_inputs_is_not_taken(tmp_path):
    with pytest.raises(Killed):
        count_to_ten(tmp_path, die_at=8, key="a")
    total, steps = count_to_ten(tmp_path, key="b")
    assert total == 55 and steps == list(range(1, 11))


def test_only_scenes_without_a_result_are_computed_and_all_in_one_call(tmp_path):
    calls = []

    def double(entities, library, settings):
        calls.append(list(entities))
        return [(np.array(2 * len(name + library)),) for name in entities]

    def run(names, library="kit"):
        runner = StageRunner([StageStore(tmp_path / name) for name in names], Recorder())
        found = runner.run(preset("default"), stage("entities"), double, names, library)
        return [int(one[0]) for one in found]

    assert run(["a", "bb"]) == [8, 10]
    assert run(["ccc", "a", "dddd", "bb"]) == [12, 8, 14, 10]
    assert calls == [["a", "bb"], ["ccc", "dddd"]]
    assert run(["a"], library="other") == [12], "what all scenes share is part of the key"


def test_stages_are_those_of_the_pipeline_in_its_order():
    from isr_jax import alignment, contact_graph, entities, mapping, matching, physical_check

    ours = (mapping, entities, contact_graph, matching, alignment, physical_check)
    assert tuple(package.STAGE.name for package in ours) == STAGES
    for package in ours:
        assert package.STAGE.version == package.VERSION
        assert package.STAGE.settings[0] == package.STAGE.name
