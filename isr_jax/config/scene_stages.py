"""The settings of the stages from entities to a scene that stands.

Numbers that only scale things are passed to kernels as arrays; those that set shapes are marked
``static`` and recompile when they change.
"""

from __future__ import annotations

import dataclasses

from .fields import Checked, setting


@dataclasses.dataclass(frozen=True)
class SupportSettings(Checked):
    """What counts as a support, from the contact graph to the evaluation."""

    up_cosine: float = setting(
        0.9, "a_th: a supporting plane has n . g of at most minus this", low=0.0, high=1.0
    )
    min_contact: float = setting(
        0.5, "b_th: least contact ratio A of a stable support", low=0.0, high=1.0
    )


DEFAULT_SUPPORT = SupportSettings()


@dataclasses.dataclass(frozen=True)
class ContactGraphSettings(Checked):
    """Supports and proximal pairs."""

    near_voxels: float = setting(
        2.0, "vertices so near a plane count as on it", unit="voxels", low=0.0
    )
    rim_voxels: float = setting(
        2.0,
        "and those so far around the child's bottom as below it, where it hides them",
        unit="voxels",
        low=0.0,
    )
    min_score: float = setting(
        0.1, "least S of a support; bounds how far a hidden foot may hover", low=0.0, high=1.0
    )
    max_gap_m: float = setting(
        0.3,
        "a thing may hover so far above another; what stands on layout may hover farther",
        unit="m",
        low=0.0,
    )
    max_gap_mounted_m: float = setting(
        0.04, "the same for classes that hang on walls: they hover for good", unit="m", low=0.0
    )
    max_sink_m: float = setting(
        0.1,
        "a thing's bottom may lie so far below a plane of another that carries it",
        unit="m",
        low=0.0,
    )
    layout_whole_polygon: bool = setting(
        True, "layout carries with its whole polygon, since it is rarely seen under furniture"
    )
    layout_margin_m: float = setting(
        1.0,
        "and with so much more on every side, since it is not seen behind it either",
        unit="m",
        low=0.0,
    )
    attach_distance_m: float = setting(
        0.1, "gap to a wall at which a thing hangs on it", unit="m", low=0.0
    )
    attach_distance_mounted_m: float = setting(
        0.4,
        "the same for classes that hang on walls, whose backs are not seen (paper: 0.1)",
        unit="m",
        low=0.0,
    )
    inside_furniture: bool = setting(
        True,
        "what nothing carries, in the box of furniture, stands on a board of it that was not "
        "seen (paper: not)",
    )


@dataclasses.dataclass(frozen=True)
class CadSettings(Checked):
    """How imported models without collision hulls get them. Models of the kit have theirs."""

    candidate_hulls: str = setting(
        "vhacd", "of the models that may be chosen: many, so fast", choices=("coacd", "vhacd")
    )
    chosen_hulls: str = setting(
        "coacd", "of the models that a scene is written with", choices=("coacd", "vhacd")
    )


@dataclasses.dataclass(frozen=True)
class MatchingSettings(Checked):
    """The matching distance D(x, y) and the shortlist."""

    weight_size: float = setting(1.0, "of d_s", low=0.0)
    weight_planes: float = setting(1.0, "of d_pi", low=0.0)
    weight_upright: float = setting(
        1.0, "of d_b; the paper's 0.2 put half-seen chairs on their heads", low=0.0
    )
    weight_wall: float = setting(
        0.2, "of d_w: backs go to the wall, as in the released code (paper: 0)", low=0.0
    )
    wall_distance_m: float = setting(0.3, "gap to a wall from which d_w counts", unit="m", low=0.0)
    unmatched_cost: float = setting(
        0.5, "of an entity's plane without partner; inf rejects (paper)", low=0.0
    )
    merge_symmetric: bool = setting(
        True, "rotations that a model's symmetry makes equal take one place of the shortlist"
    )
    shortlist: int = setting(10, "candidates that go on", low=1, static=True)
    turned_models: int = setting(
        4,
        "so many of their models also go on in the upright turns that are missing (paper: 0)",
        low=0,
        static=True,
    )


@dataclasses.dataclass(frozen=True)
class AlignmentSettings(Checked):
    """Levenberg-Marquardt over scale, yaw and horizontal position."""

    weight_support: float = setting(8.0, "of heights of supporting planes, 1/m", low=0.0)
    weight_normal: float = setting(5.0, "of plane normals", low=0.0)
    weight_offset: float = setting(5.0, "of plane offsets, 1/m", low=0.0)
    weight_footprint: float = setting(0.5, "of the footprint inside the entity's box, 1/m", low=0.0)
    weight_height: float = setting(2.0, "of equal height, 1/m", low=0.0)
    weight_scale: float = setting(0.5, "of log alpha: models come in true size (paper: 0)", low=0.0)
    normal_residual: str = setting(
        "vector",
        "n - n' (7 steps measured), or the paper's 1 - n . n' (317)",
        choices=("vector", "paper"),
    )
    scale_min: float = setting(0.6, "lower bound of alpha", low=0.01, high=1.0)
    scale_max: float = setting(1.6, "upper bound of alpha", low=1.0, high=100.0)
    prior_weight: float = setting(0.05, "of the start; keeps the system regular", low=0.0)
    max_steps: int = setting(64, "LM steps", low=1, static=True)
    tolerance: float = setting(1e-5, "relative and absolute", low=0.0)
    max_points: int = setting(2048, "entity vertices that AE is taken over", low=16, static=True)
    slide_hidden_m: float = setting(
        0.05,
        "a model that sticks out of a half-seen entity's box by more is also tried flush with its "
        "sides; inf = not (paper)",
        unit="m",
        low=0.0,
    )


@dataclasses.dataclass(frozen=True)
class PhysicalCheckSettings(Checked):
    """Which candidates stand together."""

    penetration_tolerance_m: float = setting(0.005, "deeper overlaps conflict", unit="m", low=0.0)
    scan_tolerance_m: float = setting(
        0.03, "a kept scan, noisy as it is, may reach so far into a model", unit="m", low=0.0
    )
    layout_tolerance_m: float = setting(
        0.15,
        "a candidate that sinks less into a wall is moved out of it; others are dropped",
        unit="m",
        low=0.0,
    )
    child_height_tolerance_m: float = setting(
        0.1,
        "a plane carries a child whose bottom is so near; the child then moves onto it",
        unit="m",
        low=0.0,
    )
    max_nudge_m: float = setting(
        0.05, "farthest that a model is moved sideways out of another; 0 = never", unit="m", low=0.0
    )
    clearance_m: float = setting(
        0.0002, "gap left below what stands and beside what was moved", unit="m", low=0.0, high=0.01
    )
    matching_weight_m: float = setting(
        0.05,
        "the choice is by AE + this times D: AE alone ties under flips (paper: 0)",
        unit="m",
        low=0.0,
    )
    scale_weight_m: float = setting(
        0.1, "+ this times |log alpha|: models come in true size (paper: 0)", unit="m", low=0.0
    )
    max_alignment_error_m: float = setting(
        0.1, "a candidate with a larger AE is dropped", unit="m", low=0.0
    )
    max_rounds: int = setting(200, "min-conflicts rounds", low=1)
    seed: int = setting(0, "seed of the min-conflicts draws", low=0)


@dataclasses.dataclass(frozen=True)
class ExportSettings(Checked):
    """What is written, and the contact model of the MJCF."""

    timestep_s: float = setting(0.002, "of MuJoCo", unit="s", low=1e-4, high=0.02)
    friction: float = setting(
        0.8, "sliding friction of layout and scans; models have their own", low=0.0
    )
    scan_max_faces: int = setting(4000, "faces of an exported scan mesh", low=16)
    max_hull_vertices: int = setting(64, "of a collision part", low=32, high=256)
    layout_thickness_m: float = setting(
        0.1, "of the boxes behind floor, walls and ceiling", unit="m", low=0.01, high=1.0
    )
    floor_margin_m: float = setting(
        0.5, "the floor reaches so far past what was seen of it", unit="m", low=0.0
    )
    max_shift_m: float = setting(
        0.15, "farthest that a free body is moved to touch its support", unit="m", low=0.0
    )


@dataclasses.dataclass(frozen=True)
class StabilitySettings(Checked):
    """ISR-Stab."""

    duration_s: float = setting(5.0, "simulated time", unit="s", low=0.1)
    perturbed_resets: int = setting(8, "resets with jittered poses; 0 = none", low=0)
    perturbation_m: float = setting(0.002, "size of the jitter", unit="m", low=0.0)
    seed: int = setting(0, "seed of the jitter", low=0)
