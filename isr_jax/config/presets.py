"""Named settings: ours, the paper's, and the mapping baseline."""

from __future__ import annotations

import dataclasses

from ..errors import SettingError
from .map_stages import EntitySettings, MappingSettings, SegmentationSettings
from .scene_stages import (
    AlignmentSettings,
    ContactGraphSettings,
    MatchingSettings,
    PhysicalCheckSettings,
)
from .settings import Settings

_PAPER = Settings(
    preset="paper",
    segmentation=SegmentationSettings(fill_from_masks=False, cut_out_stuff=False),
    mapping=MappingSettings(
        label_band_voxels=4.0,
        carve=False,
        share_labels=False,
        merge_any_class=True,
        instance_merge_min=10,
        instance_min_frames=1,
        regulate_classes=False,
        mesh_max_jump_voxels=20.0,
    ),
    entities=EntitySettings(
        wall_min_top_m=0.0,
        box_trim=0.0,
        box_normal_weight=0.0,
        piece_min_ratio=0.0,
        min_coverage=0.0,
        merge_inside_ratio=2.0,
        hung_min_bottom_m=float("inf"),
        plane_min_area_m2=0.0,
        board_min_area_m2=float("inf"),
    ),
    contact_graph=ContactGraphSettings(
        rim_voxels=1.0,
        min_score=0.2,
        max_gap_m=1.0,
        max_gap_mounted_m=1.0,
        max_sink_m=1.0,
        layout_whole_polygon=False,
        layout_margin_m=0.0,
        attach_distance_mounted_m=0.1,
        inside_furniture=False,
    ),
    matching=MatchingSettings(
        weight_upright=0.2,
        weight_wall=0.0,
        unmatched_cost=float("inf"),
        merge_symmetric=False,
        turned_models=0,
    ),
    alignment=AlignmentSettings(
        weight_scale=0.0,
        slide_hidden_m=float("inf"),
        normal_residual="paper",
        scale_min=0.5,
        scale_max=2.0,
        prior_weight=0.01,
        max_steps=512,
    ),
    physical_check=PhysicalCheckSettings(
        max_alignment_error_m=0.15,
        max_nudge_m=0.0,
        child_height_tolerance_m=10.0,
        matching_weight_m=0.0,
        scale_weight_m=0.0,
    ),
)
_VOXBLOX = dataclasses.replace(
    _PAPER,
    preset="voxblox++",
    segmentation=SegmentationSettings(
        fill_from_masks=False,
        cut_out_stuff=False,
        bilateral=False,
        remove_outliers=False,
        majority_ratio=0.8,
    ),
    mapping=dataclasses.replace(
        _PAPER.mapping, counts="pairs", regulate=False, merge_overlap_ratio=0.1, merge_min_frames=2
    ),
)
PRESETS: dict[str, Settings] = {"default": Settings(), "paper": _PAPER, "voxblox++": _VOXBLOX}
"""``paper``: the paper's numbers, its gaps filled as its released code fills them.
``voxblox++``: the paper's baseline in mapping (Grinvald et al. 2019, the values of its published
configuration): a mask labels the depth segments that it covers, pair counts, no regulation of
instances; voxels, rays and all after the map as in ``paper``, so that the two differ in mapping
alone."""


def preset(name: str) -> Settings:
    """Settings by name: ``default``, ``paper`` or ``voxblox++``.

    Raises:
        SettingError: no preset has that name.
    """
    if name not in PRESETS:
        raise SettingError(f"unknown preset {name!r}", f"use one of: {', '.join(PRESETS)}")
    return PRESETS[name]
