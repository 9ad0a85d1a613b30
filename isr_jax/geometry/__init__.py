"""Pure geometry kernels that stages share: transforms, boxes, planes, the 24 rotations."""

from .boxes import (
    box_corners,
    box_iou,
    box_overlap_depth,
    canonical_box,
    footprint_corners,
    footprint_overlap_area,
    points_in_box_frame,
)
from .planes import plane_height, transform_planes
from .rotations import CUBE_ROTATIONS, rotated_size
from .transforms import invert_T, make_T, rot_z, transform_points, wrap_angle
from .triangles import point_triangle_distance_sq, points_to_mesh_distance

__all__ = [
    "CUBE_ROTATIONS",
    "box_corners",
    "box_iou",
    "box_overlap_depth",
    "canonical_box",
    "footprint_corners",
    "footprint_overlap_area",
    "invert_T",
    "make_T",
    "plane_height",
    "point_triangle_distance_sq",
    "points_in_box_frame",
    "points_to_mesh_distance",
    "rot_z",
    "rotated_size",
    "transform_planes",
    "transform_points",
    "wrap_angle",
]
