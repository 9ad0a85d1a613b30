"""Settings: every number of the pipeline, with its unit, default, bound and one phrase of meaning.

Presets are values of `Settings`; the resolved settings are saved beside every result.
"""

from .fields import setting
from .map_stages import (
    Association,
    EntitySettings,
    InputSettings,
    LabelCounts,
    MappingSettings,
    OnnxProvider,
    SegmentationSettings,
)
from .page import section_names, settings_page, settings_section
from .presets import PRESETS, preset
from .scene_stages import (
    DEFAULT_SUPPORT,
    AlignmentSettings,
    CadSettings,
    ContactGraphSettings,
    ExportSettings,
    HullMethod,
    HullsToCheck,
    MatchingSettings,
    NormalResidual,
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
    "Association",
    "CadSettings",
    "ContactGraphSettings",
    "EntitySettings",
    "ExportSettings",
    "HullMethod",
    "HullsToCheck",
    "InputSettings",
    "LabelCounts",
    "MappingSettings",
    "MatchingSettings",
    "NoiseModel",
    "NormalResidual",
    "OnnxProvider",
    "PhysicalCheckSettings",
    "PoseNoise",
    "SegmentationSettings",
    "Settings",
    "StabilitySettings",
    "SupportSettings",
    "preset",
    "section_names",
    "setting",
    "settings_from_dict",
    "settings_from_toml",
    "settings_page",
    "settings_section",
    "settings_to_dict",
    "settings_to_toml",
    "with_overrides",
]
