"""Rigid and articulated models: the one reader and writer of URDF and MJCF bodies and joints."""

from .model import Joint, Link, RobotModel, Visual

__all__ = ["Joint", "Link", "RobotModel", "Visual"]
