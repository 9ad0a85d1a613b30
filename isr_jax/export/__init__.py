"""Placements to MJCF, URDF (a ROS package), GLB and scene.json, each read back and checked."""

from .stage import export_scene

VERSION: int = 3

__all__ = ["VERSION", "export_scene"]
