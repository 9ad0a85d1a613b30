"""Settings: bounds, presets, overrides, round trips."""

from __future__ import annotations

import dataclasses
import json
import math
import re

import pytest

from isr_jax.cad.checking.settings import CheckSettings
from isr_jax.cad.importing.converting.settings import ConvertSettings
from isr_jax.config import (
    PRESETS,
    MappingSettings,
    NoiseModel,
    PoseNoise,
    Settings,
    preset,
    section_names,
    settings_from_toml,
    settings_page,
    settings_section,
    settings_to_dict,
    settings_to_toml,
    with_overrides,
)
from isr_jax.errors import SettingError

from .conftest import REPOSITORY

MID_SENTENCE = re.compile(
    r"(of|and|or|but|so|times|the same|between|\+|\.\.\.|=)(?!\w)|.* likewise"
)
"""How a meaning begins that reads on from the one above it: `config.toml` prints each alone."""


def all_fields():
    """(section, field) of every setting, also of those that are no section of a run's."""
    kinds = {name: type(getattr(Settings(), name)) for name in section_names()}
    kinds |= {"noise": NoiseModel, "pose noise": PoseNoise}
    kinds |= {"isr cad check": CheckSettings, "isr cad add": ConvertSettings}
    for name, kind in kinds.items():
        yield from ((name, field) for field in dataclasses.fields(kind))


@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_survives_the_file_it_is_saved_in(name, tmp_path):
    path = tmp_path / "config.toml"
    path.write_text(settings_to_toml(preset(name)))
    assert settings_from_toml(path) == preset(name)


@pytest.mark.parametrize("name", PRESETS)
def test_every_preset_can_stand_in_a_scene_file(name):
    """JSON has no infinity, and the paper's preset rejects models by an infinite cost."""
    data = json.loads(json.dumps(settings_to_dict(preset(name)), allow_nan=False))
    assert data["preset"] == name
    assert (data["matching"]["unmatched_cost"] == "inf") == (name != "default")


def test_every_setting_says_what_it_means_by_itself():
    meanings: dict[str, str] = {}
    for section, field in all_fields():
        name, meaning = f"{section}.{field.name}", field.metadata["help"]
        assert len(meaning.split()) > 1 and not MID_SENTENCE.match(meaning), f"{name}: {meaning}"
        assert meaning not in meanings, f"{name} and {meanings[meaning]} mean the same"
        meanings[meaning] = name


def test_a_meaning_that_reads_on_from_the_one_above_is_caught():
    for phrase in ("of d_s", "+ this times D", "and the distance", "times z", "so may rugs"):
        assert MID_SENTENCE.match(phrase)
    assert not MID_SENTENCE.match("offset of a plane")


def test_the_page_of_settings_is_the_one_that_is_committed():
    page = (REPOSITORY / "docs" / "settings.md").read_text("utf-8")
    assert page == settings_page(), "write it again: isr settings --out docs/settings.md"


def test_the_page_shows_bounds_choices_units_and_where_presets_differ():
    rows = [row for row in settings_section("mapping").splitlines() if row.startswith("| ")]
    cells = {row.split(" | ")[0]: row.split(" | ") for row in rows}
    assert cells["| setting"][2:5] == ["default", "paper", "voxblox++"]
    assert cells["| `voxel_size_m`"][:6] == [
        "| `voxel_size_m`",
        "m",
        "0.01",
        "",
        "",
        "0.002 to 0.2",
    ]
    assert cells["| `counts`"][2:6] == ["triplet", "", "pairs", "triplet, pairs"]
    assert cells["| `carve`"][2:6] == ["true", "false", "false", "true, false"]
    assert "paper" not in settings_section("export").splitlines()[4]
    with pytest.raises(SettingError, match="mapping"):
        settings_section("map")


def test_overrides_reach_the_named_setting_alone():
    changed = with_overrides(
        preset("default"), ["mapping.voxel_size_m=0.05", "mapping.counts=pairs"]
    )
    assert changed.mapping.voxel_size_m == 0.05 and changed.mapping.counts == "pairs"
    assert dataclasses.replace(changed, mapping=MappingSettings()) == preset("default")


def test_paper_preset_rejects_models_that_lack_a_plane():
    assert math.isinf(preset("paper").matching.unmatched_cost)


@pytest.mark.parametrize(
    ("override", "says"),
    [
        ("mapping.voxel_size_m=5", "between 0.002 and 0.2 m"),
        ("mapping.voxel_size_m=abc", "give a float"),
        ("mapping.voxel=0.1", "voxel_size_m"),
        ("map.voxel_size_m=0.1", "mapping"),
        ("mapping.voxel_size_m", "section.name=value"),
        ("mapping.counts=kimera", "triplet"),
        ("contact_graph.layout_whole_polygon=maybe", "give a bool"),
    ],
)
def test_a_wrong_setting_is_refused_with_the_way_out(override, says):
    with pytest.raises(SettingError, match="(?s)" + says.replace("+", r"\+")):
        with_overrides(preset("default"), [override])


def test_an_unknown_preset_names_the_known_ones():
    with pytest.raises(SettingError, match="default, paper, voxblox"):
        preset("best")


def test_a_file_that_is_not_toml_is_named(tmp_path):
    path = tmp_path / "config.toml"
    path.write_text("[mapping\n")
    with pytest.raises(SettingError, match=r"config\.toml is not TOML"):
        settings_from_toml(path)
