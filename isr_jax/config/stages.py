"""The settings of each stage.

Numbers that only scale things are passed to kernels as arrays; those that set shapes are marked
``static`` and recompile when they change.
"""

from __future__ import annotations

import dataclasses

from .fields import Checked, setting


@dataclasses.dataclass(frozen=True)
class InputSettings(Checked):
    """Which frames are read, and which depth is believed."""

    stride: int = setting(1, "use every n-th frame", low=1)
    max_frames: int = setting(0, "stop after so many frames; 0 = all", low=0)
    depth_min_m: float = setting(0.1, "nearer returns are dropped", unit="m", low=0.0)
    depth_max_m: float = setting(4.0, "farther returns are dropped", unit="m", low=0.1, high=20.0)
    max_bad_fraction: float = setting(
        0.5, "share of unreadable frames at which the run stops", low=0.0, high=1.0
    )


@dataclasses.dataclass(frozen=True)
class SegmentationSettings(Checked):
    """Per-frame segmentation: depth segments, and their fusion with masks."""

    normal_window: int = setting(
        13, "side of the window of a normal", unit="px", low=3, static=True
    )
    normal_depth_ratio: float = setting(
        0.05, "neighbours within this share of the depth count towards a normal", low=0.0, high=1.0
    )
    discontinuity_window: int = setting(3, "side of the window", unit="px", low=3, static=True)
    discontinuity_ratio: float = setting(
        0.01, "depth step, as a share of the depth, that makes an edge", low=0.0, high=1.0
    )
    convexity_window: int = setting(5, "side of the window", unit="px", low=3, static=True)
    convexity_mask_m: float = setting(
        -0.0005, "point-to-plane distance below which it is concave", unit="m"
    )
    convexity_threshold: float = setting(
        0.97, "cosine between normals that keeps pixels together", low=-1.0, high=1.0
    )
    edge_join_window: int = setting(
        9, "side of the window in which edge pixels join a segment", unit="px", low=1
    )
    edge_join_distance_m: float = setting(0.05, "and the distance", unit="m", low=0.0)
    min_seed_px: int = setting(
        50, "smaller specks between edges are treated as edges", unit="px", low=0
    )
    min_segment_px: int = setting(500, "smaller depth segments are dropped", unit="px", low=0)
    bilateral: bool = setting(
        True, "masks split segments too; else they only label them (Voxblox++)"
    )
    mask_in_segment_ratio: float = setting(
        0.9,
        "an instance with this share of its mask in one segment may be cut out of it",
        low=0.0,
        high=1.0,
    )
    cut_out_ratio: float = setting(
        0.5, "and is, if it covers less than this share of the segment", low=0.0, high=1.0
    )
    majority_ratio: float = setting(
        0.2, "a segment whose best mask covers less is background", low=0.0, high=1.0
    )
    split_ratio: float = setting(
        0.2, "a mask with this share of a segment splits it, and ...", low=0.0, high=1.0
    )
    split_mask_ratio: float = setting(
        0.5, "... only if this share of the mask lies in the segment", low=0.0, high=1.0
    )
    fill_from_masks: bool = setting(
        True, "pixels with depth that no segment holds follow their mask (paper: not)"
    )
    min_piece_px: int = setting(
        100, "smaller pieces are not cut out of a segment", unit="px", low=0
    )
    remove_outliers: bool = setting(
        True, "pieces of a thing far from the rest of it go to the background (Voxblox++: not)"
    )
    cluster_distance_m: float = setting(
        0.05,
        "pieces of an instance farther apart are separate clusters; all but the largest go",
        unit="m",
        low=0.0,
    )
    min_score: float = setting(0.4, "masks with a lower score are ignored", low=0.0, high=1.0)
    onnx_provider: str = setting(
        "auto",
        "where ONNX models run; auto: CUDA where it works, else the CPU",
        choices=(
            "auto",
            "cpu",
            "cuda",
            "tensorrt",
            "migraphx",
            "openvino",
            "directml",
            "coreml",
        ),
    )
    onnx_threads: int = setting(0, "CPU threads of an ONNX model; 0 = all cores", low=0)


@dataclasses.dataclass(frozen=True)
class MappingSettings(Checked):
    """Voxel fusion and label fusion."""

    counts: str = setting(
        "triplet",
        "label fusion counts label, class and instance together, or (Voxblox++) in pairs",
        choices=("triplet", "pairs"),
    )
    voxel_size_m: float = setting(0.01, "side of a voxel", unit="m", low=0.002, high=0.2)
    truncation_voxels: float = setting(
        4.0, "truncation distance", unit="voxels", low=1.0, high=20.0
    )
    max_weight: float = setting(1e4, "cap of a voxel's TSDF weight", low=1.0)
    block_capacity: int = setting(
        16384, "blocks of 8^3 voxels to start with; doubles when full", low=64, static=True
    )
    max_blocks: int = setting(262144, "bound of the capacity", low=64)
    frames_per_step: int = setting(
        1, "frames that wait for each other and fuse in one call", low=1, high=16, static=True
    )
    keep_frames: bool = setting(False, "keep frames in memory, to fuse them again at other poses")
    label_slots: int = setting(3, "label counts kept a voxel", low=1, high=8, static=True)
    label_band_voxels: float = setting(
        2.0, "voxels this near the surface count its label", unit="voxels", low=0.5, high=20.0
    )
    carve: bool = setting(True, "known blocks that are seen through are freed (paper: not)")
    min_votes: int = setting(20, "voxel votes a segment needs to take a map label", low=1)
    association: str = setting(
        "greedy",
        "how segments take map labels, and frame instances global ones: the largest count first, "
        "or the greatest sum of counts",
        choices=("greedy", "optimal"),
    )
    share_labels: bool = setting(
        True, "segments of one instance in a frame may take one map label (paper: not)"
    )
    merge_overlap_ratio: float = setting(
        0.2, "shared voxels at which two segments merge", low=0.0, high=1.0
    )
    merge_min_frames: int = setting(3, "and the frames in which they did", low=1)
    merge_any_class: bool = setting(
        False, "segments of decided, different classes may merge (paper, Voxblox++: yes)"
    )
    instance_count_ratio: float = setting(
        0.1, "a label is part of an instance if its count exceeds this share of the rest", low=0.0
    )
    instance_condition: str = setting(
        "group",
        "classes that one instance may have: those of a match group, or (paper) one",
        choices=("group", "class"),
    )
    instance_min_frames: int = setting(
        2, "an instance seen in fewer frames is not believed (paper: 1)", low=1
    )
    regulate: bool = setting(True, "instances that lastingly share labels merge (Voxblox++: not)")
    instance_merge_ratio: float = setting(
        0.5, "shared count over the smaller total at which two instances merge", low=0.0
    )
    instance_merge_min: int = setting(5, "and the least shared count (paper: 10)", low=1)
    regulate_classes: bool = setting(True, "instances of different classes may merge (paper: not)")
    checkpoint_every: int = setting(50, "frames between checkpoints; 0 = none", low=0)
    mesh_min_weight: float = setting(1e-4, "voxels with less are unobserved", low=0.0)
    mesh_max_jump_voxels: float = setting(
        6.0,
        "no surface where distances in a cell differ more (silhouettes)",
        unit="voxels",
        low=1.0,
    )


@dataclasses.dataclass(frozen=True)
class EntitySettings(Checked):
    """Map to entities: meshes, boxes, planes, layout."""

    min_vertices: int = setting(60, "instances with fewer mesh vertices are dropped", low=3)
    box_trim: float = setting(
        0.005, "share of vertices an end that may stick out of the box", low=0.0, high=0.2
    )
    piece_link_m: float = setting(
        0.1, "pieces of a mesh nearer than this are one", unit="m", low=0.01
    )
    piece_min_ratio: float = setting(
        0.2, "other pieces with a smaller share of the largest are dropped", low=0.0, high=1.0
    )
    drop_fragments: bool = setting(
        True, "instances smaller than their class's min_diagonal_m are dropped"
    )
    min_coverage: float = setting(
        0.1,
        "and so are those whose surface is a smaller share of their box's largest side: scattered "
        "flakes (paper: 0)",
        low=0.0,
    )
    merge_inside_ratio: float = setting(
        0.8,
        "an instance with this share of its vertices in the box of a larger one of its class, or "
        "beside it at this share of its height, is a part of it (paper: never, above 1)",
        low=0.0,
        high=2.0,
    )
    hung_min_bottom_m: float = setting(
        1.1,
        "things of a class with a hung_class take that class from this height (paper: never)",
        unit="m",
        low=0.0,
    )
    box_normal_weight: float = setting(
        0.5, "weight of the faces' normals beside the area in a box's yaw (paper: 0)", low=0.0
    )
    plane_threshold_m: float = setting(0.03, "RANSAC inlier distance, at most", unit="m", low=0.0)
    plane_iterations: int = setting(200, "RANSAC draws a plane", low=1, static=True)
    plane_min_ratio: float = setting(
        0.1, "a plane holds at least this share of the vertices", low=0.0, high=1.0
    )
    max_planes: int = setting(8, "planes an entity", low=1, high=10, static=True)
    plane_min_area_m2: float = setting(
        0.01, "smaller planes are dropped: a cup has none (paper: 0)", unit="m^2", low=0.0
    )
    board_min_area_m2: float = setting(
        0.03,
        "in what stands fixed, level planes of this area are looked for beyond the largest planes; "
        "inf = not (paper)",
        unit="m^2",
        low=0.0,
    )
    max_boards: int = setting(8, "and so many are taken", low=1, high=10, static=True)
    wall_min_top_m: float = setting(
        1.2, "upright planes of the wall class that end lower are no walls", unit="m", low=0.0
    )
    layout_min_area_m2: float = setting(
        0.5, "smaller layout planes are dropped", unit="m^2", low=0.0
    )
    seed: int = setting(0, "seed of the RANSAC draws", low=0)


@dataclasses.dataclass(frozen=True)
class ContactGraphSettings(Checked):
    """Supports and proximal pairs."""

    up_cosine: float = setting(0.9, "a supporting plane has n . g <= -this", low=0.0, high=1.0)
    min_contact: float = setting(
        0.5, "contact area ratio A of a stable support (b_th)", low=0.0, high=1.0
    )
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

    min_contact: float = setting(
        0.5, "a candidate's plane must carry each child with this A", low=0.0, high=1.0
    )
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


@dataclasses.dataclass(frozen=True)
class Settings:
    """All settings, a stage each. Saved beside every result as ``config.toml``."""

    preset: str = "default"
    input: InputSettings = dataclasses.field(default_factory=InputSettings)
    segmentation: SegmentationSettings = dataclasses.field(default_factory=SegmentationSettings)
    mapping: MappingSettings = dataclasses.field(default_factory=MappingSettings)
    entities: EntitySettings = dataclasses.field(default_factory=EntitySettings)
    contact_graph: ContactGraphSettings = dataclasses.field(default_factory=ContactGraphSettings)
    cad: CadSettings = dataclasses.field(default_factory=CadSettings)
    matching: MatchingSettings = dataclasses.field(default_factory=MatchingSettings)
    alignment: AlignmentSettings = dataclasses.field(default_factory=AlignmentSettings)
    physical_check: PhysicalCheckSettings = dataclasses.field(default_factory=PhysicalCheckSettings)
    export: ExportSettings = dataclasses.field(default_factory=ExportSettings)
    stability: StabilitySettings = dataclasses.field(default_factory=StabilitySettings)
