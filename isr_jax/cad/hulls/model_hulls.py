"""All hulls of one model, link by link, from plain arrays: what a worker process computes."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float, Int
from scipy.spatial import QhullError

from ...config import HullMethod
from ...robot_model import RobotModel, link_transforms
from ...types import Mesh
from .link_hulls import bound_m, link_hulls
from .parting import parted
from .solid import Hull, hull_of

_REPORTED_OVERLAP_M = 0.005
_SWEEP_POSITIONS = 33
_MAX_SWEPT_JOINTS = 24


@dataclasses.dataclass(frozen=True, eq=False)
class LinkShape:
    """Seen triangles of a link, welded, link frame, and where it is."""

    name: str
    vertices: Float[np.ndarray, "vertices 3"]
    faces: Int[np.ndarray, "faces 3"]
    T_model_link: Float[np.ndarray, "poses 4 4"]
    """At rest, then with one joint after the other partly and wholly open."""


@dataclasses.dataclass(frozen=True, eq=False)
class ModelHulls:
    """Hulls of all links of a model."""

    links: tuple[tuple[Mesh, ...], ...]
    swelling_m: float
    """How far they reach beyond the surface at most."""
    notes: tuple[str, ...]


def link_shapes(robot: RobotModel) -> tuple[LinkShape, ...]:
    """What the hulls of a robot are made from."""
    poses = [link_transforms(robot, opened) for opened in _openings(robot)]
    return tuple(
        LinkShape(
            link.name,
            *_welded([v.mesh for v in link.visuals]),
            np.stack([pose[link.name] for pose in poses]),
        )
        for link in robot.links
    )


def _openings(robot: RobotModel) -> list[dict[str, float]]:
    """Rest, and each moving joint at some positions of its range, the others at rest."""
    found: list[dict[str, float]] = [{}]
    for joint in robot.moving_joints[:_MAX_SWEPT_JOINTS]:
        full = joint.kind == "continuous"
        low, high = (-np.pi, np.pi) if full else (joint.lower, joint.upper)
        steps = np.linspace(low, high, _SWEEP_POSITIONS)
        found += [{joint.name: float(q)} for q in steps if abs(q) > 1e-6]
    return found


def _welded(meshes: list[Mesh]) -> tuple[np.ndarray, np.ndarray]:
    """One mesh of several, equal corners joined to a hundredth of a millimetre."""
    points, faces, count = [np.zeros((0, 3))], [np.zeros((0, 3), np.int64)], 0
    for mesh in meshes:
        points.append(mesh.vertices.astype(np.float64))
        faces.append(mesh.faces.astype(np.int64) + count)
        count += len(mesh.vertices)
    vertices, rows = np.concatenate(points), np.concatenate(faces)
    _, first, inverse = np.unique(
        np.round(vertices, 5), axis=0, return_index=True, return_inverse=True
    )
    rows = inverse.reshape(-1)[rows]
    ordered = np.sort(rows, 1)
    kept = (ordered[:, 0] != ordered[:, 1]) & (ordered[:, 1] != ordered[:, 2])
    _, once = np.unique(ordered[kept], axis=0, return_index=True)
    return vertices[first], rows[kept][np.sort(once)]


def model_hulls(shapes: tuple[LinkShape, ...], method: HullMethod) -> ModelHulls:
    """Hulls of every link that is seen, cut so that no link's hulls reach into another's."""
    hulls: list[list[Hull]] = []
    notes: list[str] = []
    swelling = 0.0
    for shape in shapes:
        if not len(shape.faces):
            hulls.append([])
            continue
        try:
            made = link_hulls(shape.vertices, shape.faces, method)
        except (RuntimeError, ValueError, QhullError) as error:
            notes.append(f"{shape.name}: one convex hull, {method} failed ({error})"[:160])
            hulls.append([hull_of(shape.vertices)])
            continue
        hulls.append(made.hulls)
        swelling = max(swelling, made.swelling_m)
        notes += [f"{shape.name}: {note}" for note in made.notes]
        limit = bound_m(np.ptp(shape.vertices, axis=0))
        if made.swelling_m > 1.5 * limit:
            reach = f"{1000 * made.swelling_m:.0f} mm beyond the surface"
            notes.append(f"{shape.name}: hulls reach {reach} (aim: {1000 * limit:.0f} mm)")
    hulls, depth = parted(hulls, np.stack([shape.T_model_link for shape in shapes], 1))
    if depth > _REPORTED_OVERLAP_M:
        notes.append(f"hulls of neighbouring links overlapped by {1000 * depth:.0f} mm: cut apart")
    meshes = tuple(tuple(hull.mesh() for hull in own) for own in hulls)
    return ModelHulls(meshes, swelling, tuple(notes))
