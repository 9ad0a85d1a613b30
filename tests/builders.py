"""Small analytic entities and models that tests of several stages share."""

from __future__ import annotations

import dataclasses

import jax
import numpy as np

from isr_jax.classes import class_named
from isr_jax.geometry import stack_boxes, support_heights
from isr_jax.geometry.boxes import canonical_box
from isr_jax.library import CadLibrary, CadModel, held, library_arrays
from isr_jax.robot_model import Link, RobotModel, Visual
from isr_jax.types import ContactGraph, Entities, Entity, Mesh, PlaneSet

FACE_AXES = [(axis, sign) for axis in (2, 0, 1) for sign in (1.0, -1.0)]
"""Order of the planes of a box: top, bottom, +x, -x, +y, -y."""


def rotation_z(yaw: float) -> np.ndarray:
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]], np.float32)


def box_mesh(size, center=(0, 0, 0), yaw: float = 0.0, spacing_m: float = 0.05) -> Mesh:
    """A closed box with its faces cut into squares of about ``spacing_m``, normals outward."""
    size, vertices, faces, normals = np.asarray(size, np.float32), [], [], []
    for axis, sign in FACE_AXES:
        u, v = [(1, 2), (2, 0), (0, 1)][axis]
        nu, nv = (max(1, round(float(size[i]) / spacing_m)) for i in (u, v))
        gu, gv = np.meshgrid(np.linspace(-0.5, 0.5, nu + 1), np.linspace(-0.5, 0.5, nv + 1))
        points = np.zeros((gu.size, 3), np.float32)
        points[:, u], points[:, v] = gu.ravel() * size[u], gv.ravel() * size[v]
        points[:, axis] = sign * size[axis] / 2
        corner = (np.arange(nv)[:, None] * (nu + 1) + np.arange(nu)).ravel()
        quads = np.stack([corner, corner + 1, corner + nu + 2, corner + nu + 1], 1)
        triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
        faces.append((triangles if sign > 0 else triangles[:, ::-1]) + sum(map(len, vertices)))
        vertices.append(points)
        normals.append(np.tile(sign * np.eye(3, dtype=np.float32)[axis], (len(points), 1)))
    R = rotation_z(yaw)
    moved = np.concatenate(vertices) @ R.T + np.asarray(center, np.float32)
    return Mesh(
        moved.astype(np.float32),
        np.concatenate(faces).astype(np.int32),
        np.full((len(moved), 3), 128, np.uint8),
        (np.concatenate(normals) @ R.T).astype(np.float32),
    )


def box_planes(size, center=(0, 0, 0), yaw: float = 0.0, faces=range(6)) -> PlaneSet:
    """The chosen faces of a box (order of `FACE_AXES`) as planes with outward normals."""
    size, R = np.asarray(size, np.float32), rotation_z(yaw)
    rows = []
    for axis, sign in (FACE_AXES[i] for i in faces):
        u, v = [(1, 2), (2, 0), (0, 1)][axis]
        normal = sign * np.eye(3, dtype=np.float32)[axis]
        corners = np.zeros((4, 3), np.float32)
        signs = np.array([(-1, -1), (1, -1), (1, 1), (-1, 1)], np.float32)[:: int(sign)]
        corners[:, u], corners[:, v] = signs[:, 0] * size[u] / 2, signs[:, 1] * size[v] / 2
        corners[:, axis] = sign * size[axis] / 2
        corners = corners @ R.T + np.asarray(center, np.float32)
        rows.append((R @ normal, -(R @ normal) @ corners[0], corners, size[u] * size[v]))
    normal, offset, corners, area = (np.array(c, np.float32) for c in zip(*rows, strict=True))
    return PlaneSet(normal, offset, corners, area, np.ones(len(rows), bool))


def box_entity(id, class_name, center, size, yaw=0.0, faces=(0, 2, 3, 4, 5)) -> Entity:
    """A solid box as an entity; by default its underside was not seen as a plane."""
    return Entity(
        id=id,
        name=f"{class_name}_{id}",
        class_name=class_name,
        box=canonical_box(np.asarray(center, np.float32), yaw, np.asarray(size, np.float32)),
        planes=box_planes(size, center, yaw, faces),
        mesh=box_mesh(size, center, yaw),
        is_layout=class_named(class_name).kind == "layout",
    )


def floor_entity(id=1, size=(5.0, 4.0)) -> Entity:
    """The floor at z = 0, one up-facing plane."""
    return box_entity(id, "floor", (0, 0, -0.01), (*size, 0.02), faces=(0,))


def scene_of(*items: Entity, voxel_size_m: float = 0.02) -> Entities:
    return Entities(tuple(items), np.eye(4), voxel_size_m)


def parts_model(cad_id, class_name, parts, density=500.0, supporting_top=True) -> CadModel:
    """A one-link model of solid boxes: ``parts`` = [(size, center), ...]; box centred at 0."""
    meshes = [box_mesh(size, center, spacing_m=10.0) for size, center in parts]
    low = np.min([m.vertices.min(0) for m in meshes], 0)
    high = np.max([m.vertices.max(0) for m in meshes], 0)
    assert np.allclose(low + high, 0, atol=1e-6), "centre the parts on the origin"
    mass, first, inertia = 0.0, np.zeros(3), np.zeros((3, 3))
    for size, center in parts:
        m = density * float(np.prod(size))
        mass, first = mass + m, first + m * np.asarray(center)
    com = first / mass
    for size, center in parts:
        m, s, r = density * float(np.prod(size)), np.asarray(size), np.asarray(center) - com
        inertia += m * (np.eye(3) * (s @ s) - np.diag(s * s)) / 12
        inertia += m * (np.eye(3) * (r @ r) - np.outer(r, r))
    link = Link(
        "base",
        tuple(Visual(f"part_{i}", m, (0.7, 0.6, 0.5, 1.0)) for i, m in enumerate(meshes)),
        tuple(meshes),
        mass,
        com,
        inertia,
    )
    planes = [box_planes(size, center) for size, center in parts]
    merged = jax.tree.map(lambda *leaves: np.concatenate(leaves), *planes)
    count = len(merged.offset)
    return CadModel(
        id=cad_id,
        class_name=class_name,
        load_robot=held(RobotModel(cad_id.replace("/", "_"), (link,), ())),
        moving_joints=(),
        size=(high - low).astype(np.float32),
        planes=merged,
        plane_link=("base",) * count,
        plane_supporting=merged.normal[:, 2] > 0.9 if supporting_top else np.zeros(count, bool),
        symmetry=2,
        mount=class_named(class_name).mount,
        licence="MIT",
        content_hash=cad_id,
    )


def with_robot(model: CadModel, robot: RobotModel) -> CadModel:
    """The model with other links and joints, its box and planes kept."""
    joints = tuple(joint.name for joint in robot.moving_joints)
    return dataclasses.replace(model, load_robot=held(robot), moving_joints=joints)


def without_hulls(model: CadModel) -> CadModel:
    """The model as an import leaves it: nothing to collide with yet."""
    links = tuple(dataclasses.replace(link, hulls=()) for link in model.robot.links)
    bare = with_robot(model, dataclasses.replace(model.robot, links=links))
    return dataclasses.replace(bare, collision="none")


def table_model(cad_id="table/test", size=(1.2, 0.8, 0.74)) -> CadModel:
    """A table: a top and four legs."""
    x, y, z = size
    leg, top = 0.06, 0.03
    legs = [
        ((leg, leg, z - top), (sx * (x - leg) / 2, sy * (y - leg) / 2, -top / 2))
        for sx in (-1, 1)
        for sy in (-1, 1)
    ]
    return parts_model(cad_id, "table", [((x, y, top), (0, 0, (z - top) / 2)), *legs])


def library_of(*models: CadModel) -> CadLibrary:
    models = tuple(sorted(models, key=lambda m: m.id))
    return CadLibrary(models, "test library", "+".join(m.content_hash for m in models))


def planes_that_count(planes: PlaneSet, supporting: np.ndarray) -> np.ndarray:
    """Those of a model that matching reads, ascending."""
    arrays = library_arrays([np.ones(3)], [planes], [supporting], [1])
    return arrays.column[0, arrays.valid[0]]


def support_graph(
    entities: Entities, parents, planes=None, *, attachment=None, score=None, proximal=None
) -> ContactGraph:
    """A graph given by positions, boxes as they are; a parent carries with its first plane (the
    top) unless ``planes`` says otherwise. ``proximal``: pairs and depths."""
    parent = np.array(parents, np.int32)
    plane = np.where(parent >= 0, 0, -1) if planes is None else np.array(planes)
    box = stack_boxes([entity.box for entity in entities])
    pairs, depth = proximal or (np.zeros((0, 2), np.int32), np.zeros(0, np.float32))
    return ContactGraph(
        parent=parent,
        support_plane=plane.astype(np.int32),
        score=np.float32(score if score is not None else np.ones(len(parent))),
        attachment=tuple(attachment or ["none"] * len(parent)),
        refined_box=box,
        support_height_m=support_heights(entities.items, parent, plane, box),
        proximal=pairs,
        proximal_depth_m=depth,
    )
