"""Settings: bounds, presets, overrides, round trips."""

from __future__ import annotations

import dataclasses
import json
import math

import pytest

from isr_jax.config import (
    PRESETS,
    MappingSettings,
    preset,
    settings_from_toml,
    settings_to_dict,
    settings_to_toml,
    with_overrides,
)
from isr_jax.errors import SettingError


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


def test_every_setting_says_what_it_means():
    for section in dataclasses.fields(preset("default")):
        stage = getattr(preset("default"), section.name)
        if section.name == "preset":
            continue
        for field in dataclasses.fields(stage):
            assert field.metadata.get("help"), f"{section.name}.{field.name}"


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
