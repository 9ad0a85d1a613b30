"""The settings of the stages from entities to a scene that stands.

Numbers that only scale things are passed to kernels as arrays, so that changing them recompiles
nothing; those that set shapes (windows, capacities, counts of rows) recompile.
"""

from __future__ import annotations

import dataclasses
from typing import Literal

from .fields import Checked, setting

HullMethod = Literal["coacd", "vhacd"]
"""How a mesh is decomposed into convex hulls: CoACD, or V-HACD, which is faster and coarser."""
HullsToCheck = Literal["stored", HullMethod]
"""Which hulls a library's check looks at: those that are there, or also new ones for the models
without."""
NormalResidual = Literal["vector", "paper"]
"""How the alignment compares two normals: by n - n', or by the paper's 1 - n . n'."""


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
        2.0, "distance within which a vertex counts as on a plane", unit="voxels", low=0.0
    )
    rim_voxels: float = setting(
        2.0,
        "distance around the child's bottom within which a vertex counts as below it, hidden by it",
        unit="voxels",
        low=0.0,
    )
    min_score: float = setting(
        0.1, "least S of a support, which bounds how far a hidden foot may hover", low=0.0, high=1.0
    )
    max_gap_m: float = setting(
        0.3,
        "farthest that a thing may hover above another; above layout it may hover farther",
        unit="m",
        low=0.0,
    )
    max_gap_mounted_m: float = setting(
        0.04,
        "farthest that a thing of a class that hangs on walls may hover above another",
        unit="m",
        low=0.0,
    )
    max_sink_m: float = setting(
        0.1,
        "farthest that a thing's bottom may lie below the plane that carries it",
        unit="m",
        low=0.0,
    )
    layout_whole_polygon: bool = setting(
        True,
        "layout carries with its whole polygon, as it is rarely seen under furniture (paper: not)",
    )
    layout_margin_m: float = setting(
        1.0,
        "margin by which a layout plane carries beyond what was seen of it, as furniture hides it "
        "(paper: 0)",
        unit="m",
        low=0.0,
    )
    attach_distance_m: float = setting(
        0.1, "gap to a wall within which a thing hangs on it", unit="m", low=0.0
    )
    attach_distance_mounted_m: float = setting(
        0.4,
        "gap to a wall within which a thing of a class that hangs on walls hangs on it; backs "
        "are not seen (paper: 0.1)",
        unit="m",
        low=0.0,
    )
    inside_furniture: bool = setting(
        True,
        "a thing in the box of furniture that nothing carries stands on a board that was not seen "
        "(paper: not)",
    )


@dataclasses.dataclass(frozen=True)
class CadSettings(Checked):
    """How imported models without collision hulls get them. Models of the kit have theirs."""

    candidate_hulls: HullMethod = setting(
        "vhacd",
        "decomposition for the hulls of models that may be chosen: many, so a fast one",
    )
    chosen_hulls: HullMethod = setting(
        "coacd",
        "decomposition for the hulls of models that a scene is written with",
    )


@dataclasses.dataclass(frozen=True)
class MatchingSettings(Checked):
    """The matching distance D(x, y) and the shortlist."""

    weight_size: float = setting(
        1.0, "w_s: weight in D of d_s, the difference in proportions", low=0.0
    )
    weight_planes: float = setting(
        1.0, "w_pi: weight in D of d_pi, the difference in planes", low=0.0
    )
    weight_upright: float = setting(
        1.0,
        "w_b: weight in D of d_b, whether the model is upright; the paper's 0.2 put half-seen "
        "chairs on their heads",
        low=0.0,
    )
    weight_wall: float = setting(
        0.2,
        "w_w: weight in D of d_w, backs to the wall, as in the released code (paper: 0)",
        low=0.0,
    )
    wall_distance_m: float = setting(
        0.3, "gap to a wall within which d_w counts", unit="m", low=0.0
    )
    unmatched_cost: float = setting(
        0.5,
        "cost in d_pi of an entity's plane without partner; inf = such a model is rejected (paper)",
        low=0.0,
    )
    merge_symmetric: bool = setting(
        True, "rotations that a model's symmetry makes equal take one place of the shortlist"
    )
    shortlist: int = setting(10, "candidates per entity that go on to the alignment", low=1)
    turned_models: int = setting(
        4,
        "models of the shortlist that also go on in the upright turns that it lacks (paper: 0)",
        low=0,
    )


@dataclasses.dataclass(frozen=True)
class AlignmentSettings(Checked):
    """Levenberg-Marquardt over scale, yaw and horizontal position."""

    weight_support: float = setting(
        8.0, "weight of the heights of supporting planes in e_p", unit="1/m", low=0.0
    )
    weight_normal: float = setting(5.0, "weight of the planes' normals in e_p", low=0.0)
    weight_offset: float = setting(5.0, "weight of the planes' offsets in e_p", unit="1/m", low=0.0)
    weight_footprint: float = setting(
        0.5, "weight in e_b of what sticks out of the entity's box sideways", unit="1/m", low=0.0
    )
    weight_height: float = setting(
        2.0, "weight in e_b of the difference in height from the entity's", unit="1/m", low=0.0
    )
    weight_scale: float = setting(
        0.5, "weight of log alpha in e_b: models come in true size (paper: 0)", low=0.0
    )
    normal_residual: NormalResidual = setting(
        "vector",
        "residual of two normals: vector = n - n' (7 steps measured), paper = 1 - n . n' (317)",
    )
    scale_min: float = setting(0.6, "lower bound of the scale alpha", low=0.01, high=1.0)
    scale_max: float = setting(1.6, "upper bound of the scale alpha", low=1.0, high=100.0)
    prior_weight: float = setting(
        0.05, "weight of the way from the start in J, which keeps the system regular", low=0.0
    )
    max_steps: int = setting(64, "most Levenberg-Marquardt steps of one candidate", low=1)
    tolerance: float = setting(
        1e-5, "relative and absolute tolerance at which the alignment has converged", low=0.0
    )
    max_points: int = setting(2048, "entity vertices that AE is taken over", low=16)
    slide_hidden_m: float = setting(
        0.05,
        "distance out of a half-seen entity's box from which a model is also tried flush with the "
        "box's sides; inf = not (paper)",
        unit="m",
        low=0.0,
    )


@dataclasses.dataclass(frozen=True)
class PhysicalCheckSettings(Checked):
    """Which candidates stand together."""

    penetration_tolerance_m: float = setting(
        0.005, "depth of overlap above which two candidates conflict", unit="m", low=0.0
    )
    scan_tolerance_m: float = setting(
        0.03, "depth that a kept scan, noisy as it is, may reach into a model", unit="m", low=0.0
    )
    layout_tolerance_m: float = setting(
        0.15,
        "depth in a wall up to which a candidate is moved out of it; deeper ones are dropped",
        unit="m",
        low=0.0,
    )
    child_height_tolerance_m: float = setting(
        0.1,
        "height between a plane and a child's bottom within which it carries the child, which then "
        "moves onto it",
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
        "weight of D beside AE in the choice: AE alone ties under flips (paper: 0)",
        unit="m",
        low=0.0,
    )
    scale_weight_m: float = setting(
        0.1,
        "weight of |log alpha| beside AE in the choice: models come in true size (paper: 0)",
        unit="m",
        low=0.0,
    )
    max_alignment_error_m: float = setting(
        0.1, "AE above which a candidate is dropped", unit="m", low=0.0
    )
    max_rounds: int = setting(200, "most min-conflicts rounds", low=1)
    seed: int = setting(0, "seed of the min-conflicts draws", low=0)


@dataclasses.dataclass(frozen=True)
class ExportSettings(Checked):
    """What is written, and the contact model of the MJCF."""

    timestep_s: float = setting(0.002, "time step of MuJoCo", unit="s", low=1e-4, high=0.02)
    friction: float = setting(
        0.8, "sliding friction of layout and scans; models have their own", low=0.0
    )
    scan_max_faces: int = setting(4000, "most faces of an exported scan mesh", low=16)
    max_hull_vertices: int = setting(64, "most vertices of a collision hull", low=32, high=256)
    layout_thickness_m: float = setting(
        0.1, "thickness of the boxes behind floor, walls and ceiling", unit="m", low=0.01, high=1.0
    )
    floor_margin_m: float = setting(
        0.5, "distance that the floor reaches past what was seen of it", unit="m", low=0.0
    )
    max_shift_m: float = setting(
        0.15, "farthest that a free body is moved to touch its support", unit="m", low=0.0
    )


@dataclasses.dataclass(frozen=True)
class StabilitySettings(Checked):
    """ISR-Stab."""

    duration_s: float = setting(5.0, "simulated time", unit="s", low=0.1)
    perturbed_resets: int = setting(8, "simulations from jittered poses; 0 = none", low=0)
    perturbation_m: float = setting(0.002, "size of the jitter of those poses", unit="m", low=0.0)
    seed: int = setting(0, "seed of the jitter of poses", low=0)
