"""Settings: every number of the pipeline, with its unit, default, bound and one line of meaning.

Presets are values of `Settings`; the resolved settings are saved beside every result.
"""

from .fields import setting
from .map_stages import EntitySettings, InputSettings, MappingSettings, SegmentationSettings
from .presets import PRESETS, preset
from .scene_stages import (
    DEFAULT_SUPPORT,
    AlignmentSettings,
    CadSettings,
    ContactGraphSettings,
    ExportSettings,
    MatchingSettings,
    PhysicalCheckSettings,
    StabilitySettings,
    SupportSettings,
)
from .sensor import NoiseModel, PoseNoise
from .settings import Settings
from .text import (
    settings_from_dict,
    settings_from_toml,
    settings_to_dict,
    settings_to_toml,
    with_overrides,
)

__all__ = [
    "DEFAULT_SUPPORT",
    "PRESETS",
    "AlignmentSettings",
    "CadSettings",
    "ContactGraphSettings",
    "EntitySettings",
    "ExportSettings",
    "InputSettings",
    "MappingSettings",
    "MatchingSettings",
    "NoiseModel",
    "PhysicalCheckSettings",
    "PoseNoise",
    "SegmentationSettings",
    "Settings",
    "StabilitySettings",
    "SupportSettings",
    "preset",
    "setting",
    "settings_from_dict",
    "settings_from_toml",
    "settings_to_dict",
    "settings_to_toml",
    "with_overrides",
]
