"""All that is seen of a model as one mesh."""

from __future__ import annotations

import numpy as np

from ..types import Mesh
from .kinematics import link_transforms
from .model import RobotModel


def merged_mesh(robot: RobotModel) -> Mesh:
    """All visuals in the root frame, joints at zero.

    Coloured a vertex where a visual is, else by its material (a texture's mean colour).
    """
    poses = link_transforms(robot)
    vertices, faces, colors, count = [], [], [], 0
    for link in robot.links:
        T = poses[link.name]
        for visual in link.visuals:
            points = visual.mesh.vertices.astype(np.float64) @ T[:3, :3].T + T[:3, 3]
            vertices.append(points.astype(np.float32))
            faces.append(visual.mesh.faces + np.int32(count))
            rgb = np.rint(255 * np.clip(visual.rgba[:3], 0, 1)).astype(np.uint8)
            own = visual.mesh.colors
            colors.append(np.tile(rgb, (len(points), 1)) if own is None else own)
            count += len(points)
    return Mesh(np.concatenate(vertices), np.concatenate(faces), np.concatenate(colors))
