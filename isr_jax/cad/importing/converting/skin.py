"""The seen surface of a model, its skin: one triangle soup with equal corners welded."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
from jaxtyping import Bool, Float, Int

from ....borders.raycast import RayScene
from ....robot_model import RobotModel, link_transforms
from ....types import Mesh

_WELD_SHARE = 1e-5
"""Of the diagonal: corners that are nearer are one."""


@dataclasses.dataclass(frozen=True, eq=False)
class Skin:
    """Triangles of all visuals, joints at zero, root frame, without the degenerate ones."""

    vertices: Float[np.ndarray, "vertices 3"]
    """Welded."""
    faces: Int[np.ndarray, "faces 3"]
    link: Int[np.ndarray, " faces"]
    """Position of the link in the robot."""
    visual: Int[np.ndarray, " faces"]
    """Position among all visuals, link by link."""
    row: Int[np.ndarray, " faces"]
    """Row in that visual's faces."""
    doubled: Bool[np.ndarray, " faces"]
    """The file has the face twice, wound both ways; here it is once."""

    @functools.cached_property
    def corners(self) -> Float[np.ndarray, "faces 3 3"]:
        return self.vertices[self.faces]

    @functools.cached_property
    def _cross(self) -> np.ndarray:
        c = self.corners
        return np.cross(c[:, 1] - c[:, 0], c[:, 2] - c[:, 0])

    @functools.cached_property
    def area(self) -> Float[np.ndarray, " faces"]:
        return np.linalg.norm(self._cross, axis=1) / 2

    @functools.cached_property
    def normal(self) -> Float[np.ndarray, "faces 3"]:
        """Unit, by the winding."""
        return self._cross / (2 * self.area[:, None])

    @functools.cached_property
    def size(self) -> Float[np.ndarray, "3"]:
        return np.ptp(self.vertices, axis=0)

    @functools.cached_property
    def rays(self) -> RayScene:
        """For casting rays against all of it."""
        mesh = Mesh(self.vertices.astype(np.float32), self.faces.astype(np.int32))
        return RayScene([mesh], [1])

    def flipped(self, flip: Bool[np.ndarray, " faces"]) -> Skin:
        """The same skin, the marked faces wound the other way."""
        faces = np.where(flip[:, None], self.faces[:, ::-1], self.faces)
        return dataclasses.replace(self, faces=faces)

    def shifted(self, step: Float[np.ndarray, "3"]) -> Skin:
        """The same skin, moved."""
        return dataclasses.replace(self, vertices=self.vertices + step)

    def only(self, kept: Bool[np.ndarray, " faces"]) -> Skin:
        """Some of its faces."""
        rows = {k: getattr(self, k)[kept] for k in ("faces", "link", "visual", "row", "doubled")}
        return dataclasses.replace(self, **rows)

    def samples(self, count: int) -> Float[np.ndarray, "samples 3"]:
        """Points spread evenly over the area, the same every time."""
        ends = np.cumsum(self.area)
        at = (np.arange(count) + 0.5) / count * ends[-1]
        face = np.minimum(np.searchsorted(ends, at), len(ends) - 1)
        # A sequence of low discrepancy (the plastic number's powers) within the triangles.
        k = np.arange(count)
        u, v = (0.5 + k * 0.7548776662466927) % 1, (0.5 + k * 0.5698402909980532) % 1
        over = u + v > 1
        u, v = np.where(over, 1 - u, u), np.where(over, 1 - v, v)
        a, b, c = np.moveaxis(self.corners[face], 1, 0)
        return a + u[:, None] * (b - a) + v[:, None] * (c - a)


def skin_of(robot: RobotModel) -> Skin:
    """The welded skin of a robot's visuals; may have no faces."""
    poses = link_transforms(robot)
    points, faces = [np.zeros((0, 3))], [np.zeros((0, 3), np.int64)]
    owners, count, position = [np.zeros((0, 3), np.int64)], 0, 0
    for i, link in enumerate(robot.links):
        T = poses[link.name]
        for visual in link.visuals:
            mesh = visual.mesh
            points.append(mesh.vertices.astype(np.float64) @ T[:3, :3].T + T[:3, 3])
            faces.append(mesh.faces.astype(np.int64) + count)
            rows = np.arange(len(mesh.faces))
            owners.append(np.stack([np.full_like(rows, i), np.full_like(rows, position), rows], 1))
            count += len(mesh.vertices)
            position += 1
    return _welded(np.concatenate(points), np.concatenate(faces), np.concatenate(owners))


def _welded(points: np.ndarray, faces: np.ndarray, owner: np.ndarray) -> Skin:
    """Corners of one link within the welding distance become one; empty faces go."""
    if not len(faces):
        link, visual, row = owner.T
        return Skin(points, faces, link, visual, row, np.zeros(0, bool))
    used = points[faces].reshape(-1, 3)
    diagonal = max(float(np.linalg.norm(np.ptp(used, axis=0))), 1e-9)
    keys = np.round((points - used.min(0)) / (diagonal * _WELD_SHARE)).astype(np.int64)
    # Links stay apart: a closed drawer that touches its carcass is not one body with it.
    links = np.zeros(len(points), np.int64)
    links[faces] = owner[:, :1]
    mixed = (links << 51) | (keys[:, 0] << 34) | (keys[:, 1] << 17) | keys[:, 2]
    _, first, inverse = np.unique(mixed, return_index=True, return_inverse=True)
    vertices, faces = points[first], inverse[faces]
    corners = vertices[faces]
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    kept = np.linalg.norm(cross, axis=1) > 1e-12 * diagonal**2
    kept &= (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2])
    kept &= faces[:, 2] != faces[:, 0]
    return _without_copies(vertices, faces[kept], owner[kept])


def _without_copies(vertices: np.ndarray, faces: np.ndarray, owner: np.ndarray) -> Skin:
    """Of faces over the same three corners the first."""
    ordered = np.sort(faces, 1)
    low, first, third = (ordered[:, k].astype(np.int64) for k in range(3))
    count = np.int64(len(vertices))
    pair = np.unique(low * count + first, return_inverse=True)[1]
    _, kept, group = np.unique(pair * count + third, return_index=True, return_inverse=True)
    # The sign of the permutation that sorts a face: which way it is wound.
    a, b, c = faces.T
    even = ((a < b) ^ (b < c) ^ (c < a)).astype(np.int64)
    ways = np.bincount(group, even, len(kept)) / np.bincount(group, minlength=len(kept))
    order = np.argsort(kept)
    kept, both = kept[order], ((ways > 0) & (ways < 1))[order]
    link, visual, row = owner[kept].T
    return Skin(vertices, faces[kept], link, visual, row, both)
