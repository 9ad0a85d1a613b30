"""Border: the scene as a ROS package with one URDF (plain XML)."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import numpy as np

from ..robot_model import Joint, Texture, joint_element, robot_elements, xml_bytes
from ..robot_model.mesh_files import MeshFiles, write_text
from ..scene_file import ROOM_NAME
from ..types import Mesh
from .bodies import Body
from .mjcf_scene import front_sheet
from .scan_bodies import mean_color
from .slabs import Slab

PACKAGE = "scene_description"
WORLD = "world"
"""Root link. MuJoCo takes a link of this name for its world, the one place for floating joints."""

_PACKAGE_XML = f"""<?xml version="1.0"?>
<package format="3">
  <name>{PACKAGE}</name>
  <version>0.1.0</version>
  <description>A reconstructed scene: layout, furniture, objects, joints.</description>
  <maintainer email="nobody@example.org">nobody</maintainer>
  <license>MIT</license>
  <buildtool_depend>ament_cmake</buildtool_depend>
  <exec_depend>joint_state_publisher_gui</exec_depend>
  <exec_depend>launch_ros</exec_depend>
  <exec_depend>robot_state_publisher</exec_depend>
  <exec_depend>rviz2</exec_depend>
  <export>
    <build_type>ament_cmake</build_type>
  </export>
</package>
"""
_CMAKE = f"""cmake_minimum_required(VERSION 3.8)
project({PACKAGE} NONE)
find_package(ament_cmake REQUIRED)
install(DIRECTORY urdf meshes launch DESTINATION share/${{PROJECT_NAME}})
ament_package()
"""
_LAUNCH = f'''"""Show the scene in RViz: ros2 launch {PACKAGE} display.launch.py"""

from pathlib import Path

from ament_index_python.packages import get_package_share_directory
from launch import LaunchDescription
from launch_ros.actions import Node


def generate_launch_description():
    share = Path(get_package_share_directory("{PACKAGE}"))
    description = (share / "urdf" / "scene.urdf").read_text()
    return LaunchDescription(
        [
            Node(
                package="robot_state_publisher",
                executable="robot_state_publisher",
                parameters=[{{"robot_description": description}}],
            ),
            Node(package="joint_state_publisher_gui", executable="joint_state_publisher_gui"),
            Node(package="rviz2", executable="rviz2", arguments=["-f", "{WORLD}"]),
        ]
    )
'''


def write_urdf_package(out_dir: Path, slabs: tuple[Slab, ...], bodies: tuple[Body, ...]) -> Path:
    """Write ``scene_description/``; returns the path of the URDF.

    What stands is fixed to the link ``room``, what moves floats from the root ``world`` (the same
    frame): MuJoCo wants floating joints there, and who carries whom is in scene.json.
    """
    package = out_dir / PACKAGE
    files = MeshFiles(package / "meshes")

    def mesh_uri(mesh: Mesh, stem: str, texture: Texture | None = None) -> str:
        return f"package://{PACKAGE}/meshes/{files.add(mesh, stem, texture)}"

    root = ET.Element("robot", name="scene")
    # For MuJoCo, which else drops fixed links; open scans and flat sheets among the visuals have
    # no volume, which it refuses in a URDF (scene.xml has them all).
    settings = {
        "meshdir": "../meshes",
        "strippath": "true",
        "discardvisual": "true",
        "fusestatic": "false",
    }
    ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", settings)
    ET.SubElement(root, "link", name=WORLD)
    ET.SubElement(root, "link", name=ROOM_NAME)
    root.append(_root_joint(ROOM_NAME, np.eye(4), WORLD))
    for slab in slabs:
        root.append(_slab_link(slab, mesh_uri))
        root.append(_root_joint(slab.name, slab.T_world_slab, ROOM_NAME))
    for body in bodies:
        root.extend(robot_elements(body.robot, "", mesh_uri))
        parent = WORLD if body.free else ROOM_NAME
        root.append(_root_joint(body.name, body.T_world_root, parent, body.free))
    path = package / "urdf" / "scene.urdf"
    write_text(path, xml_bytes(root).decode())
    write_text(package / "package.xml", _PACKAGE_XML)
    write_text(package / "CMakeLists.txt", _CMAKE)
    write_text(package / "launch" / "display.launch.py", _LAUNCH)
    return path


def _root_joint(name: str, T: np.ndarray, parent: str, free: bool = False) -> ET.Element:
    kind = "free" if free else "fixed"
    joint = Joint(f"{name}_{kind}", "fixed", parent, name, T, np.array([0.0, 0.0, 1.0]))
    element = joint_element(joint)
    if free:
        element.set("type", "floating")
    return element


def _slab_link(slab: Slab, mesh_uri) -> ET.Element:
    link = ET.Element("link", name=slab.name)
    visual = ET.SubElement(link, "visual", name=f"{slab.name}_sheet")
    uri = mesh_uri(front_sheet(slab), f"{slab.name}_sheet")
    ET.SubElement(ET.SubElement(visual, "geometry"), "mesh", filename=uri)
    material = ET.SubElement(visual, "material", name=f"{slab.name}_color")
    color = " ".join(f"{c:g}" for c in mean_color(slab.scan))
    ET.SubElement(material, "color", rgba=color)
    collision = ET.SubElement(link, "collision", name=f"{slab.name}_slab")
    size = " ".join(f"{s:.9g}" for s in slab.size)
    ET.SubElement(ET.SubElement(collision, "geometry"), "box", size=size)
    return link
