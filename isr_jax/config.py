"""Settings: every number of the pipeline, with its unit, default, bound and one line of meaning.

Presets are values of `Settings`. Numbers that only scale things are passed to kernels as arrays;
those that set shapes are marked ``static`` and recompile when they change.
"""

from __future__ import annotations

import dataclasses
import tomllib
from pathlib import Path
from typing import Any, Literal

from .errors import SettingError


def setting(
    default: Any,
    help: str,
    *,
    unit: str = "",
    low: float | None = None,
    high: float | None = None,
    choices: tuple[str, ...] = (),
    static: bool = False,
) -> Any:
    """A dataclass field that knows its unit, bounds and meaning."""
    metadata = {
        "help": help,
        "unit": unit,
        "low": low,
        "high": high,
        "choices": choices,
        "static": static,
    }
    return dataclasses.field(default=default, metadata=metadata)


class _Checked:
    """Checks every field against its bounds where the settings are made."""

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):  # type: ignore[arg-type]
            _check_field(type(self).__name__, field, getattr(self, field.name))


def _check_field(owner: str, field: dataclasses.Field, value: Any) -> None:
    low, high = field.metadata.get("low"), field.metadata.get("high")
    choices = field.metadata.get("choices")
    name = f"{owner}.{field.name}"
    if choices and value not in choices:
        raise SettingError(f"{name} = {value!r}", f"use one of: {', '.join(choices)}")
    if low is not None and not value >= low or high is not None and not value <= high:
        unit = field.metadata["unit"]
        raise SettingError(
            f"{name} = {value!r} {unit} is out of bounds",
            f"keep it between {low if low is not None else '-inf'} and "
            f"{high if high is not None else 'inf'} {unit}".rstrip(),
        )


@dataclasses.dataclass(frozen=True)
class InputSettings(_Checked):
    """Which frames are read, and which depth is believed."""

    stride: int = setting(1, "use every n-th frame", low=1)
    max_frames: int = setting(0, "stop after so many frames; 0 = all", low=0)
    depth_min_m: float = setting(0.1, "nearer returns are dropped", unit="m", low=0.0)
    depth_max_m: float = setting(4.0, "farther returns are dropped", unit="m", low=0.1, high=20.0)
    max_bad_fraction: float = setting(
        0.5, "share of unreadable frames at which the run stops", low=0.0, high=1.0
    )


@dataclasses.dataclass(frozen=True)
class SegmentationSettings(_Checked):
    """Per-frame segmentation: depth segments, and their fusion with masks."""

    normal_window: int = setting(13, "side of the window of a normal", unit="px", low=3, static=True)
    normal_depth_ratio: float = setting(
        0.05, "neighbours within this share of the depth count towards a normal", low=0.0, high=1.0
    )
    discontinuity_window: int = setting(3, "side of the window", unit="px", low=3, static=True)
    discontinuity_ratio: float = setting(
        0.01, "depth step, as a share of the depth, that makes an edge", low=0.0, high=1.0
    )
    convexity_window: int = setting(5, "side of the window", unit="px", low=3, static=True)
    convexity_mask_m: float = setting(-0.0005, "point-to-plane distance below which it is concave", unit="m")
    convexity_threshold: float = setting(0.97, "cosine between normals that keeps pixels together", low=-1.0, high=1.0)
    edge_join_window: int = setting(9, "side of the window in which edge pixels join a segment", unit="px", low=1)
    edge_join_distance_m: float = setting(0.05, "and the distance", unit="m", low=0.0)
    min_segment_px: int = setting(500, "smaller depth segments are dropped", unit="px", low=0)
    mask_in_segment_ratio: float = setting(
        0.9, "an instance with this share of its mask in one segment may be cut out of it", low=0.0, high=1.0
    )
    cut_out_ratio: float = setting(
        0.5, "and is, if it covers less than this share of the segment", low=0.0, high=1.0
    )
    majority_ratio: float = setting(
        0.2, "a segment whose best mask covers less is background", low=0.0, high=1.0
    )
    cluster_distance_m: float = setting(
        0.05, "pieces of an instance farther apart are separate clusters; all but the largest go", unit="m", low=0.0
    )
    min_score: float = setting(0.5, "masks with a lower score are ignored", low=0.0, high=1.0)


@dataclasses.dataclass(frozen=True)
class MappingSettings(_Checked):
    """Voxel fusion and label fusion."""

    fusion: str = setting(
        "panoptic", "label fusion: the paper's, or the baseline's pair counts", choices=("panoptic", "voxblox++")
    )
    voxel_size_m: float = setting(0.02, "side of a voxel", unit="m", low=0.002, high=0.2)
    truncation_voxels: float = setting(4.0, "truncation distance", unit="voxels", low=1.0, high=20.0)
    max_weight: float = setting(1e4, "cap of a voxel's TSDF weight", low=1.0)
    block_capacity: int = setting(16384, "blocks of 8^3 voxels to start with; doubles when full", low=64, static=True)
    max_blocks: int = setting(262144, "bound of the capacity", low=64)
    label_slots: int = setting(3, "label counts kept a voxel", low=1, high=8, static=True)
    min_votes: int = setting(20, "voxel votes a segment needs to take a map label", low=1)
    merge_overlap_ratio: float = setting(0.2, "shared voxels at which two segments merge", low=0.0, high=1.0)
    merge_min_frames: int = setting(3, "and the frames in which they did", low=1)
    instance_count_ratio: float = setting(
        0.1, "a label is part of an instance if its count exceeds this share of the rest", low=0.0
    )
    instance_merge_ratio: float = setting(0.5, "co-count over total at which two instances merge", low=0.0)
    instance_merge_min: int = setting(10, "and the least co-count", low=1)
    checkpoint_every: int = setting(50, "frames between checkpoints; 0 = none", low=0)
    mesh_min_weight: float = setting(1e-4, "voxels with less are unobserved", low=0.0)


@dataclasses.dataclass(frozen=True)
class EntitySettings(_Checked):
    """Map to entities: meshes, boxes, planes, layout."""

    min_vertices: int = setting(100, "instances with fewer mesh vertices are dropped", low=3)
    box_trim: float = setting(0.005, "share of vertices an end that may stick out of the box", low=0.0, high=0.2)
    plane_threshold_m: float = setting(0.03, "RANSAC inlier distance, at most", unit="m", low=0.0)
    plane_iterations: int = setting(200, "RANSAC draws a plane", low=1, static=True)
    plane_min_ratio: float = setting(0.1, "a plane holds at least this share of the vertices", low=0.0, high=1.0)
    max_planes: int = setting(8, "planes an entity", low=1, high=10, static=True)
    layout_min_area_m2: float = setting(0.5, "smaller layout planes are dropped", unit="m^2", low=0.0)
    seed: int = setting(0, "seed of the RANSAC draws", low=0)


@dataclasses.dataclass(frozen=True)
class ContactGraphSettings(_Checked):
    """Supports and proximal pairs."""

    up_cosine: float = setting(0.9, "a supporting plane has n . g <= -this", low=0.0, high=1.0)
    min_contact: float = setting(0.5, "contact area ratio A of a stable support (b_th)", low=0.0, high=1.0)
    near_voxels: float = setting(2.0, "vertices so near a plane count as on it", unit="voxels", low=0.0)
    min_score: float = setting(0.5, "least S of a support", low=0.0, high=1.0)
    layout_whole_polygon: bool = setting(
        True, "layout carries with its whole polygon, since it is rarely seen under furniture"
    )
    attach_distance_m: float = setting(0.1, "gap to a wall at which a thing hangs on it", unit="m", low=0.0)


@dataclasses.dataclass(frozen=True)
class MatchingSettings(_Checked):
    """The matching distance D(x, y) and the shortlist."""

    weight_size: float = setting(1.0, "of d_s", low=0.0)
    weight_planes: float = setting(1.0, "of d_pi", low=0.0)
    weight_upright: float = setting(0.2, "of d_b", low=0.0)
    unmatched_cost: float = setting(1.0, "of an entity's plane without partner; inf rejects", low=0.0)
    shortlist: int = setting(10, "candidates that go on", low=1, static=True)


@dataclasses.dataclass(frozen=True)
class AlignmentSettings(_Checked):
    """Levenberg-Marquardt over scale, yaw and horizontal position."""

    weight_support: float = setting(8.0, "of heights of supporting planes, 1/m", low=0.0)
    weight_normal: float = setting(5.0, "of plane normals", low=0.0)
    weight_offset: float = setting(5.0, "of plane offsets, 1/m", low=0.0)
    weight_footprint: float = setting(0.5, "of the footprint inside the entity's box, 1/m", low=0.0)
    weight_height: float = setting(2.0, "of equal height, 1/m", low=0.0)
    normal_residual: str = setting(
        "vector", "n - n' (7 steps measured), or the paper's 1 - n . n' (317)", choices=("vector", "paper")
    )
    scale_min: float = setting(0.5, "lower bound of alpha", low=0.01, high=1.0)
    scale_max: float = setting(2.0, "upper bound of alpha", low=1.0, high=100.0)
    prior_weight: float = setting(1e-2, "of the start; keeps the system regular", low=0.0)
    max_steps: int = setting(64, "LM steps", low=1, static=True)
    tolerance: float = setting(1e-5, "relative and absolute", low=0.0)
    max_points: int = setting(2048, "entity vertices that AE is taken over", low=16, static=True)


@dataclasses.dataclass(frozen=True)
class PhysicalCheckSettings(_Checked):
    """Which candidates stand together."""

    min_contact: float = setting(0.5, "a candidate's plane must carry each child with this A", low=0.0, high=1.0)
    penetration_tolerance_m: float = setting(0.005, "deeper overlaps conflict", unit="m", low=0.0)
    layout_tolerance_m: float = setting(
        0.15, "a candidate may sink this far into a wall", unit="m", low=0.0
    )
    max_alignment_error_m: float = setting(0.15, "a candidate with a larger AE is dropped", unit="m", low=0.0)
    max_rounds: int = setting(200, "min-conflicts rounds", low=1)
    seed: int = setting(0, "seed of the min-conflicts draws", low=0)


@dataclasses.dataclass(frozen=True)
class ExportSettings(_Checked):
    """What is written, and the contact model of the MJCF."""

    timestep_s: float = setting(0.002, "of MuJoCo", unit="s", low=1e-4, high=0.02)
    friction: float = setting(0.8, "sliding friction", low=0.0)
    scan_max_faces: int = setting(2000, "faces of an exported scan mesh", low=16)
    max_hull_vertices: int = setting(64, "of a collision part", low=8, high=256)


@dataclasses.dataclass(frozen=True)
class StabilitySettings(_Checked):
    """ISR-Stab."""

    duration_s: float = setting(5.0, "simulated time", unit="s", low=0.1)
    perturbed_resets: int = setting(8, "resets with jittered poses; 0 = none", low=0)
    perturbation_m: float = setting(0.002, "size of the jitter", unit="m", low=0.0)
    seed: int = setting(0, "seed of the jitter", low=0)


@dataclasses.dataclass(frozen=True)
class Settings:
    """All settings, a stage each. Saved beside every result as ``config.toml``."""

    preset: str = "default"
    input: InputSettings = dataclasses.field(default_factory=InputSettings)
    segmentation: SegmentationSettings = dataclasses.field(default_factory=SegmentationSettings)
    mapping: MappingSettings = dataclasses.field(default_factory=MappingSettings)
    entities: EntitySettings = dataclasses.field(default_factory=EntitySettings)
    contact_graph: ContactGraphSettings = dataclasses.field(default_factory=ContactGraphSettings)
    matching: MatchingSettings = dataclasses.field(default_factory=MatchingSettings)
    alignment: AlignmentSettings = dataclasses.field(default_factory=AlignmentSettings)
    physical_check: PhysicalCheckSettings = dataclasses.field(default_factory=PhysicalCheckSettings)
    export: ExportSettings = dataclasses.field(default_factory=ExportSettings)
    stability: StabilitySettings = dataclasses.field(default_factory=StabilitySettings)
