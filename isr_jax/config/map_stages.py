"""The settings of the stages from frames to entities.

Numbers that only scale things are passed to kernels as arrays, so that changing them recompiles
nothing; those that set shapes (windows, capacities, counts of rows) recompile.
"""

from __future__ import annotations

import dataclasses
from typing import Literal

from .fields import Checked, setting

OnnxProvider = Literal[
    "auto", "cpu", "cuda", "tensorrt", "migraphx", "openvino", "directml", "coreml"
]
"""Where ONNX models run."""
LabelCounts = Literal["triplet", "pairs"]
"""What a map label counts."""
Association = Literal["greedy", "optimal"]
"""How what is seen takes the names of what is known."""


@dataclasses.dataclass(frozen=True)
class InputSettings(Checked):
    """Which frames are read, and which depth is believed."""

    stride: int = setting(1, "use every n-th frame", low=1)
    max_frames: int = setting(0, "frames after which the run stops; 0 = all", low=0)
    depth_min_m: float = setting(0.1, "depth below which returns are dropped", unit="m", low=0.0)
    depth_max_m: float = setting(
        4.0, "depth above which returns are dropped", unit="m", low=0.1, high=20.0
    )
    max_bad_fraction: float = setting(
        0.5, "share of unreadable frames above which the run stops", low=0.0, high=1.0
    )


@dataclasses.dataclass(frozen=True)
class SegmentationSettings(Checked):
    """Per-frame segmentation: depth segments, and their fusion with masks."""

    normal_window: int = setting(
        13, "side of the window that a pixel's normal is taken over", unit="px", low=3
    )
    normal_depth_ratio: float = setting(
        0.05, "neighbours within this share of the depth count towards a normal", low=0.0, high=1.0
    )
    discontinuity_window: int = setting(
        3, "side of the window in which depth steps are looked for", unit="px", low=3
    )
    discontinuity_ratio: float = setting(
        0.01, "depth step, as a share of the depth, that makes an edge", low=0.0, high=1.0
    )
    convexity_window: int = setting(
        5, "side of the window in which concave edges are looked for", unit="px", low=3
    )
    convexity_mask_m: float = setting(
        -0.0005, "point-to-plane distance below which a neighbour makes a concave edge", unit="m"
    )
    convexity_threshold: float = setting(
        0.97,
        "cosine between normals from which a concave edge keeps its pixels together",
        low=-1.0,
        high=1.0,
    )
    edge_join_window: int = setting(
        9, "side of the window in which edge pixels join a segment", unit="px", low=1
    )
    edge_join_distance_m: float = setting(
        0.05, "distance within which edge pixels join a segment", unit="m", low=0.0
    )
    min_seed_px: int = setting(
        50, "pixels below which a speck between edges is treated as an edge", unit="px", low=0
    )
    min_segment_px: int = setting(
        500, "pixels below which a depth segment is dropped", unit="px", low=0
    )
    bilateral: bool = setting(
        True, "masks also split segments; without, they only label them (Voxblox++)"
    )
    mask_in_segment_ratio: float = setting(
        0.9,
        "share of a mask in one segment from which its instance may be cut out of it",
        low=0.0,
        high=1.0,
    )
    cut_out_ratio: float = setting(
        0.5, "share of a segment below which an instance's mask is cut out of it", low=0.0, high=1.0
    )
    cut_out_stuff: bool = setting(
        True,
        "windows, pictures and rugs, though flat, may be cut out of a segment (paper: only things)",
    )
    majority_ratio: float = setting(
        0.2,
        "least share of a segment that its best mask covers, else it is background",
        low=0.0,
        high=1.0,
    )
    split_ratio: float = setting(
        0.2, "share of a segment from which a mask may split it", low=0.0, high=1.0
    )
    split_mask_ratio: float = setting(
        0.5, "share of a mask in a segment from which it may split the segment", low=0.0, high=1.0
    )
    fill_from_masks: bool = setting(
        True, "pixels with depth that no segment holds follow their mask (paper: not)"
    )
    min_piece_px: int = setting(
        100, "pixels below which a piece is not cut out of a segment", unit="px", low=0
    )
    remove_outliers: bool = setting(
        True, "pieces of a thing far from the rest of it go to the background (Voxblox++: not)"
    )
    cluster_distance_m: float = setting(
        0.05,
        "distance from which pieces of an instance are separate clusters; all but the largest go",
        unit="m",
        low=0.0,
    )
    min_score: float = setting(0.4, "score below which a mask is ignored", low=0.0, high=1.0)
    onnx_provider: OnnxProvider = setting(
        "auto",
        "where ONNX models run; auto = CUDA where it works, else the CPU",
    )
    onnx_threads: int = setting(0, "CPU threads of an ONNX model; 0 = all cores", low=0)


@dataclasses.dataclass(frozen=True)
class MappingSettings(Checked):
    """The voxel map and its labels."""

    counts: LabelCounts = setting(
        "triplet",
        "what a map label counts: label, class and instance together, or in pairs (Voxblox++)",
    )
    voxel_size_m: float = setting(0.01, "side of a voxel", unit="m", low=0.002, high=0.2)
    truncation_voxels: float = setting(
        4.0, "truncation distance of the TSDF", unit="voxels", low=1.0, high=20.0
    )
    max_weight: float = setting(1e4, "cap of a voxel's TSDF weight", low=1.0)
    block_capacity: int = setting(
        0, "blocks of 8^3 voxels to start with, doubled when full; 0 = enough for a room", low=0
    )
    max_blocks: int = setting(262144, "blocks that the capacity may grow to", low=64)
    frames_per_step: int = setting(
        1, "frames that wait for each other and are integrated in one call", low=1, high=16
    )
    keep_frames: bool = setting(
        False, "keep frames in memory, to integrate them again at other poses"
    )
    label_slots: int = setting(3, "label counts kept per voxel", low=1, high=8)
    label_band_voxels: float = setting(
        3.0,
        "distance from the surface within which voxels count its label",
        unit="voxels",
        low=0.5,
        high=20.0,
    )
    carve: bool = setting(True, "known blocks that are seen through are freed (paper: not)")
    min_votes: int = setting(20, "voxel votes a segment needs to take a map label", low=1)
    association: Association = setting(
        "greedy",
        "how segments take map labels and frame instances take global ones: the largest count "
        "first, or the greatest sum of counts",
    )
    share_labels: bool = setting(
        True, "segments of one instance in a frame may take one map label (paper: not)"
    )
    merge_overlap_ratio: float = setting(
        0.2,
        "share of a frame segment's voxels above which two map labels each count as its own",
        low=0.0,
        high=1.0,
    )
    merge_min_frames: int = setting(
        3, "frames with segments of both above which two map labels merge", low=1
    )
    merge_any_class: bool = setting(
        False, "segments of decided, different classes may merge (paper, Voxblox++: yes)"
    )
    instance_count_ratio: float = setting(
        0.1,
        "share of a label's other counts above which an instance's count makes the label its own",
        low=0.0,
    )
    instance_min_frames: int = setting(
        2, "frames that an instance must be seen in to be believed (paper: 1)", low=1
    )
    regulate: bool = setting(True, "instances that lastingly share labels merge (Voxblox++: not)")
    instance_merge_ratio: float = setting(
        0.5, "shared count over the smaller total above which two instances merge", low=0.0
    )
    instance_merge_min: int = setting(
        5, "shared count above which two instances merge (paper: 10)", low=1
    )
    regulate_classes: bool = setting(True, "instances of different classes may merge (paper: not)")
    checkpoint_every: int = setting(50, "frames between checkpoints; 0 = none", low=0)
    mesh_min_weight: float = setting(1e-4, "TSDF weight below which a voxel is unobserved", low=0.0)
    mesh_max_jump_voxels: float = setting(
        6.0,
        "difference of the distances in one cell above which it has no surface (silhouettes)",
        unit="voxels",
        low=1.0,
    )


@dataclasses.dataclass(frozen=True)
class EntitySettings(Checked):
    """Map to entities: meshes, boxes, planes, layout."""

    min_vertices: int = setting(60, "mesh vertices below which an instance is dropped", low=3)
    box_trim: float = setting(
        0.005, "share of the vertices that may stick out of the box at each end", low=0.0, high=0.2
    )
    piece_link_m: float = setting(
        0.1, "distance below which pieces of a mesh are one", unit="m", low=0.01
    )
    piece_min_ratio: float = setting(
        0.2, "share of the largest piece below which another piece is dropped", low=0.0, high=1.0
    )
    drop_fragments: bool = setting(
        True, "instances smaller than their class's min_diagonal_m are dropped"
    )
    min_coverage: float = setting(
        0.1,
        "surface, as a share of its box's largest side, below which an instance is dropped as "
        "scattered flakes (paper: 0)",
        low=0.0,
    )
    merge_inside_ratio: float = setting(
        0.8,
        "share of its vertices in the box of a larger instance of its class, or of its height "
        "beside one, from which an instance is a part of that one (paper: never, above 1)",
        low=0.0,
        high=2.0,
    )
    hung_min_bottom_m: float = setting(
        1.1,
        "height of the bottom from which a thing takes its class's hung_class (paper: never)",
        unit="m",
        low=0.0,
    )
    box_normal_weight: float = setting(
        0.5,
        "weight of the faces' normals, beside the box's area, in the choice of its yaw (paper: 0)",
        low=0.0,
    )
    plane_threshold_m: float = setting(0.03, "RANSAC inlier distance, at most", unit="m", low=0.0)
    plane_iterations: int = setting(200, "RANSAC draws per plane", low=1)
    plane_min_ratio: float = setting(
        0.1, "least share of the vertices that a plane holds", low=0.0, high=1.0
    )
    max_planes: int = setting(8, "most planes per entity", low=1, high=10)
    plane_min_area_m2: float = setting(
        0.01, "area below which a plane is dropped: a cup has none (paper: 0)", unit="m^2", low=0.0
    )
    board_min_area_m2: float = setting(
        0.03,
        "area from which level planes are looked for, beyond the largest planes, in what stands "
        "fixed; inf = not (paper)",
        unit="m^2",
        low=0.0,
    )
    max_boards: int = setting(
        8,
        "most level planes taken, beyond the largest planes, in what stands fixed",
        low=1,
        high=10,
    )
    wall_min_top_m: float = setting(
        1.2, "top below which an upright plane of the wall class is no wall", unit="m", low=0.0
    )
    layout_min_area_m2: float = setting(
        0.5, "area below which a layout plane is dropped", unit="m^2", low=0.0
    )
    seed: int = setting(0, "seed of the RANSAC draws", low=0)
