"""Rigid and articulated models: the one reader and writer of URDF and MJCF bodies and joints."""

from .inertia import combined_properties, solid_properties
from .kinematics import joint_motion, link_transforms
from .merged import merged_mesh
from .model import Joint, JointKind, Link, RobotModel, Texture, Visual
from .primitives import as_box, box_between
from .scale import scaled
from .urdf import joint_element, read_urdf, robot_elements, urdf_files, write_urdf, xml_bytes

__all__ = [
    "Joint",
    "JointKind",
    "Link",
    "RobotModel",
    "Texture",
    "Visual",
    "as_box",
    "box_between",
    "combined_properties",
    "joint_element",
    "joint_motion",
    "link_transforms",
    "merged_mesh",
    "read_urdf",
    "robot_elements",
    "scaled",
    "solid_properties",
    "urdf_files",
    "write_urdf",
    "xml_bytes",
]
