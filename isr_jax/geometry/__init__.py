"""Pure geometry kernels that stages share: transforms, boxes, planes, the 24 rotations."""

from .boxes import (
    box_at,
    box_corners,
    box_iou,
    box_overlap_depth,
    canonical_box,
    convex_overlap_area,
    footprint_corners,
    footprint_overlap_area,
    points_in_box_frame,
    stack_boxes,
)
from .convex import (
    ConvexPart,
    box_part,
    convex_part,
    depth_inside,
    moved_part,
    penetration,
    shifted_part,
    sideways_exit,
    vertical_gap,
)
from .placed_solids import PlacedSolid, deepest_overlap
from .planes import (
    WALL_COSINE,
    beside_wall,
    plane_height_at,
    plane_heights,
    stack_planes,
    transform_planes,
)
from .rotations import CUBE_ROTATIONS, rotated_size
from .support import LEVEL_COSINE, support_heights
from .transforms import (
    invert_T,
    make_T,
    nearest_rotation,
    rot_z,
    smallest_rotation,
    wrap_angle,
)
from .triangles import (
    point_triangle_distance_sq,
    points_to_mesh_distance,
    points_to_mesh_distance_sq,
    points_to_triangles_distance_sq,
)

__all__ = [
    "CUBE_ROTATIONS",
    "LEVEL_COSINE",
    "WALL_COSINE",
    "ConvexPart",
    "PlacedSolid",
    "beside_wall",
    "box_at",
    "box_corners",
    "box_iou",
    "box_overlap_depth",
    "box_part",
    "canonical_box",
    "convex_overlap_area",
    "convex_part",
    "deepest_overlap",
    "depth_inside",
    "footprint_corners",
    "footprint_overlap_area",
    "invert_T",
    "make_T",
    "moved_part",
    "nearest_rotation",
    "penetration",
    "plane_height_at",
    "plane_heights",
    "point_triangle_distance_sq",
    "points_in_box_frame",
    "points_to_mesh_distance",
    "points_to_mesh_distance_sq",
    "points_to_triangles_distance_sq",
    "rot_z",
    "rotated_size",
    "shifted_part",
    "sideways_exit",
    "smallest_rotation",
    "stack_boxes",
    "stack_planes",
    "support_heights",
    "transform_planes",
    "vertical_gap",
    "wrap_angle",
]
