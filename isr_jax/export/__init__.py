"""Placements to MJCF, URDF (a ROS package), GLB and scene.json, each read back and checked."""

from .stage import export_scene

VERSION: int = 4

__all__ = ["VERSION", "export_scene"]
