"""The settings of the stages from frames to entities.

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
    cut_out_stuff: bool = setting(
        True, "so may windows, pictures and rugs, flat as they lie on it (paper: only things)"
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
        0, "blocks of 8^3 voxels to start with; doubles when full; 0: a room's", low=0, static=True
    )
    max_blocks: int = setting(262144, "bound of the capacity", low=64)
    frames_per_step: int = setting(
        1, "frames that wait for each other and fuse in one call", low=1, high=16, static=True
    )
    keep_frames: bool = setting(False, "keep frames in memory, to fuse them again at other poses")
    label_slots: int = setting(3, "label counts kept a voxel", low=1, high=8, static=True)
    label_band_voxels: float = setting(
        3.0, "voxels this near the surface count its label", unit="voxels", low=0.5, high=20.0
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
