"""All settings, one section per stage."""

from __future__ import annotations

import dataclasses

from .map_stages import EntitySettings, InputSettings, MappingSettings, SegmentationSettings
from .scene_stages import (
    AlignmentSettings,
    CadSettings,
    ContactGraphSettings,
    ExportSettings,
    MatchingSettings,
    PhysicalCheckSettings,
    StabilitySettings,
    SupportSettings,
)


@dataclasses.dataclass(frozen=True)
class Settings:
    """All settings, one section per stage. Saved beside every result as ``config.toml``."""

    preset: str = "default"
    input: InputSettings = dataclasses.field(default_factory=InputSettings)
    segmentation: SegmentationSettings = dataclasses.field(default_factory=SegmentationSettings)
    mapping: MappingSettings = dataclasses.field(default_factory=MappingSettings)
    entities: EntitySettings = dataclasses.field(default_factory=EntitySettings)
    support: SupportSettings = dataclasses.field(default_factory=SupportSettings)
    contact_graph: ContactGraphSettings = dataclasses.field(default_factory=ContactGraphSettings)
    cad: CadSettings = dataclasses.field(default_factory=CadSettings)
    matching: MatchingSettings = dataclasses.field(default_factory=MatchingSettings)
    alignment: AlignmentSettings = dataclasses.field(default_factory=AlignmentSettings)
    physical_check: PhysicalCheckSettings = dataclasses.field(default_factory=PhysicalCheckSettings)
    export: ExportSettings = dataclasses.field(default_factory=ExportSettings)
    stability: StabilitySettings = dataclasses.field(default_factory=StabilitySettings)
