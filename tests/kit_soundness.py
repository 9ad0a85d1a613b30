"""What makes a CAD model of the kit sound, as functions of one model."""

from __future__ import annotations

import fcl
import numpy as np
import pytest
import trimesh
from scipy.spatial import ConvexHull

from isr_jax.library import CadModel
from isr_jax.robot_model import link_transforms
from isr_jax.types import Mesh

GRID_M = 1e-6  # vertices lie on it; a sum of a few roundings stays below three of them
FLAT_M = 3 * GRID_M
SPOTS, SHARE = 16, 0.1  # a random spot in each of 16 x 16 cells; edges cut about 50 of them
CLEARANCE_M = 0.0019  # 2 mm by design, less rounding and the swing of a door's rear edge


def hulls_at_rest(model: CadModel, link: str | None = None) -> list[np.ndarray]:
    """Vertices of hulls in the canonical frame."""
    poses = link_transforms(model.robot)
    return [
        hull.vertices.astype(np.float64) + poses[part.name][:3, 3]
        for part in model.robot.links
        for hull in part.hulls
        if link in (None, part.name)
    ]


def inside_any(points: np.ndarray, hulls: list[np.ndarray]) -> np.ndarray:
    """Which points [n, 3] lie in any convex hull, by Qhull's own half-spaces."""
    inside = np.zeros(len(points), bool)
    for vertices in hulls:
        near = np.all((points >= vertices.min(0)) & (points <= vertices.max(0)), 1) & ~inside
        if near.any():
            equations = ConvexHull(vertices, qhull_options="QJ").equations
            inside[near] = np.all(points[near] @ equations[:, :3].T + equations[:, 3] <= 1e-7, 1)
    return inside


def volume_of(mesh: Mesh) -> float:
    triangles = mesh.vertices.astype(np.float64)[mesh.faces]
    return float(np.linalg.det(triangles).sum() / 6)


def face_gap(hull: Mesh, points: np.ndarray) -> float:
    """Largest height of all points above one of the hull's faces."""
    corners = hull.vertices.astype(np.float64)[hull.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    large = np.linalg.norm(normal, axis=1) > 1e-9
    normal = normal[large] / np.linalg.norm(normal[large], axis=1, keepdims=True)
    height = np.einsum("fc,fpc->fp", normal, points[None] - corners[large, :1])
    return float(height.min(1).max())


def edge_gap(a: Mesh, b: Mesh) -> float:
    """Largest gap along the products of an edge of each."""
    (va, ea), (vb, eb) = ((m.vertices.astype(np.float64), edge_vectors(m)) for m in (a, b))
    axes = np.cross(ea[:, None], eb[None]).reshape(-1, 3)
    length = np.linalg.norm(axes, axis=1)
    axes = axes[length > 1e-9] / length[length > 1e-9, None]
    pa, pb = va @ axes.T, vb @ axes.T
    return float(np.maximum(pa.min(0) - pb.max(0), pb.min(0) - pa.max(0)).max())


def edge_vectors(mesh: Mesh) -> np.ndarray:
    v = mesh.vertices.astype(np.float64)
    return np.concatenate([v[mesh.faces[:, k]] - v[mesh.faces[:, k - 1]] for k in range(3)])


def supporting_heights(model: CadModel) -> list[float]:
    """Heights above the floor, ascending."""
    z = model.planes.corners[model.plane_supporting, 0, 2] + model.size[2] / 2
    return sorted(np.round(z.astype(np.float64), 3).tolist())


def maps_onto_itself(mesh: Mesh, order: int) -> bool:
    angle = 2 * np.pi / order
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    points = mesh.vertices.astype(np.float64)
    turned = np.column_stack([points[:, :2] @ turn.T, points[:, 2]])
    keys = [{tuple(p) for p in np.round(q * 1e4).astype(int)} for q in (points, turned)]
    near = [
        any((x + i, y + j, z) in keys[0] for i in (-1, 0, 1) for j in (-1, 0, 1))
        for x, y, z in keys[1]
    ]
    return all(near)


def least_distance(model: CadModel, positions: dict[str, float], beyond_m: float = 0.02) -> float:
    """Least distance between hulls of different links; what is farther counts as ``beyond_m``."""
    poses, least = link_transforms(model.robot, positions), beyond_m
    links = []
    for link in model.robot.links:
        T = poses[link.name]
        shapes = []
        for hull in link.hulls:
            corners = hull.vertices.astype(np.float64) @ T[:3, :3].T + T[:3, 3]
            shape = fcl.CollisionObject(_convex(hull), fcl.Transform(T[:3, :3], T[:3, 3]))
            shapes.append((corners.min(0), corners.max(0), shape))
        links.append(shapes)
    for i, first in enumerate(links):
        for second in links[:i]:
            for low_a, high_a, a in first:
                for low_b, high_b, b in second:
                    if np.maximum(low_a - high_b, low_b - high_a).max() < least:
                        least = min(least, fcl.distance(a, b))
    return least


def _convex(hull: Mesh) -> fcl.Convex:
    faces = np.concatenate([np.full((len(hull.faces), 1), 3), hull.faces], 1)
    return fcl.Convex(hull.vertices.astype(np.float64), len(hull.faces), faces.ravel())


def assert_hulls_are_closed_convex_and_small(model: CadModel) -> None:
    for link in model.robot.links:
        for hull in link.hulls:
            v = hull.vertices.astype(np.float64)
            a, b, c = (v[hull.faces[:, k]] for k in range(3))
            area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
            normal = np.cross(b - a, c - a)[area > 1e-9] / area[area > 1e-9, None]
            height = np.einsum("fc,fvc->fv", normal, v[None] - a[area > 1e-9, None])
            assert height.max() < FLAT_M, model.id
            edges = [(f[i], f[(i + 1) % 3]) for f in hull.faces.tolist() for i in range(3)]
            assert len(set(edges)) == len(edges) and {e[::-1] for e in edges} == set(edges)
            assert len(v) <= 64 and volume_of(hull) > 0, model.id


def assert_visuals_are_the_skin_of_the_hulls(model: CadModel) -> None:
    for link in model.robot.links:
        for visual in link.visuals:
            mesh = visual.mesh
            skin = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
            assert skin.is_watertight and skin.is_winding_consistent, (model.id, visual.name)
        seen = sum(volume_of(v.mesh) for v in link.visuals)
        assert seen == pytest.approx(sum(map(volume_of, link.hulls)), rel=1e-5), model.id


def assert_parts_do_not_overlap(model: CadModel) -> None:
    """Any two hulls of a link are parted by a plane (separating axes), up to the grid."""
    for link in model.robot.links:
        vertices = [h.vertices.astype(np.float64) for h in link.hulls]
        bounds = [(v.min(0), v.max(0)) for v in vertices]
        for i in range(len(vertices)):
            for k in range(i):
                # Boxes that only touch are parted by the plane between them.
                least = np.minimum(bounds[i][1], bounds[k][1]) - np.maximum(
                    bounds[i][0], bounds[k][0]
                )
                if least.min() < FLAT_M:
                    continue
                a, b = link.hulls[i], link.hulls[k]
                gap = max(face_gap(a, vertices[k]), face_gap(b, vertices[i]))
                if gap <= -FLAT_M:
                    gap = edge_gap(a, b)
                assert gap > -FLAT_M, (model.id, link.name, i, k, gap)


def assert_box_is_that_of_the_body(model: CadModel, beyond_m: dict[int, float]) -> None:
    """Handles alone stand out: ``beyond_m`` by side (-x, -y, -z, +x, +y, +z)."""
    vertices, half = model.mesh.vertices, model.size / 2
    beyond = np.concatenate([-half - vertices.min(0), vertices.max(0) - half])
    assert np.all(beyond > -FLAT_M), model.id
    allowed = np.array([beyond_m.get(k, FLAT_M) for k in range(6)])
    assert np.all(beyond < allowed), (model.id, beyond)


def assert_planes_lie_on_free_surfaces(model: CadModel, rng: np.random.Generator) -> None:
    """Corners on the plane, turned about the normal; solid below, free above, area as stated."""
    planes, everything = model.planes, hulls_at_rest(model)
    assert planes.valid.all() and len(planes.offset) >= 2, model.id
    for k, link in enumerate(model.plane_link):
        normal, corners = planes.normal[k].astype(np.float64), planes.corners[k]
        assert np.linalg.norm(normal) == pytest.approx(1, abs=1e-6)
        assert np.abs(corners @ normal + planes.offset[k]).max() < FLAT_M, model.id
        u, v = corners[1] - corners[0], corners[3] - corners[0]
        assert np.cross(u, v) @ normal > 0
        np.testing.assert_allclose(corners[2], corners[0] + u + v, atol=FLAT_M)
        full = np.linalg.norm(u) * np.linalg.norm(v)
        assert 0 < planes.area_m2[k] <= full * (1 + 1e-4), model.id
        cells = np.stack(np.meshgrid(np.arange(SPOTS), np.arange(SPOTS)), -1).reshape(-1, 2)
        a, b = ((cells + rng.random((SPOTS**2, 2))) / SPOTS).T
        spots = corners[0] + a[:, None] * u + b[:, None] * v
        solid = inside_any(spots - 1e-4 * normal, hulls_at_rest(model, link))
        above = (1e-4, 0.03, 0.079) if model.plane_supporting[k] else (1e-4,)
        for height in above:
            solid &= ~inside_any(spots + height * normal, everything)
        share = np.mean(solid)
        assert share == pytest.approx(planes.area_m2[k] / full, abs=SHARE), (model.id, k)


def assert_stands_over_its_feet(model: CadModel) -> None:
    """The centre of mass, joints closed, lies well within what touches the floor."""
    poses = link_transforms(model.robot)
    mass = [link.mass_kg for link in model.robot.links]
    com = [link.com + poses[link.name][:3, 3] for link in model.robot.links]
    middle = np.average(com, 0, weights=mass)
    points = np.concatenate(hulls_at_rest(model))
    feet = ConvexHull(points[points[:, 2] < -model.size[2] / 2 + 1e-4, :2])
    margin = -(feet.equations[:, :2] @ middle[:2] + feet.equations[:, 2]).max()
    assert margin > 0.08 * np.sqrt(feet.volume), (model.id, margin)


def assert_symmetry_is_the_largest_true_one(model: CadModel, sides: int = 16) -> None:
    steps = {1: 1, 2: 2, 4: 4, 0: sides}[model.symmetry]
    assert maps_onto_itself(model.mesh, steps), model.id
    if model.symmetry in (1, 2):
        assert not maps_onto_itself(model.mesh, 2 * steps), model.id


def assert_moving_parts_keep_clear(model: CadModel, rng: np.random.Generator) -> None:
    """Clearance over the travel of each joint, and with several joints anywhere."""
    joints = model.robot.moving_joints
    range_of = {
        j.name: (-np.pi, np.pi) if j.kind == "continuous" else (j.lower, j.upper) for j in joints
    }

    def at(name: str, share: float) -> float:
        low, high = range_of[name]
        return low + share * (high - low)

    poses: list[dict[str, float]] = [{}]
    poses += [{j.name: at(j.name, q)} for j in joints for q in (0.03, 0.15, 0.5, 1.0)]
    poses += [{j.name: at(j.name, rng.random()) for j in joints} for _ in range(4)]
    poses += [{j.name: at(j.name, q) for j in joints} for q in (0.03, 0.15, 0.5, 1.0)]
    least = min(least_distance(model, q) for q in poses)
    assert least > CLEARANCE_M, (model.id, least)


def assert_opens_towards_a_hand(model: CadModel) -> None:
    """Limits and losses are set, every joint has one handle, on its link, away from its axis."""
    handles = {handle.joint: handle for handle in model.handles}
    assert set(handles) == set(model.moving_joints) and len(handles) == len(model.handles)
    for joint in model.robot.moving_joints:
        assert joint.lower <= 0 <= joint.upper and joint.damping > 0 and joint.friction > 0
        assert joint.kind == "continuous" or joint.upper > 0
        handle = handles[joint.name]
        assert handle.link == joint.child
        points = np.concatenate([h.vertices for h in model.robot.link(joint.child).hulls])
        margin = 0.01  # in front of a panel, between the studs of a bar
        assert np.all(handle.position > points.min(0) - margin), (model.id, joint.name)
        assert np.all(handle.position < points.max(0) + margin), (model.id, joint.name)
        if joint.kind != "prismatic":
            assert np.linalg.norm(np.cross(joint.axis, handle.position)) > 0.01, model.id
