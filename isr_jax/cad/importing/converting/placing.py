"""A robot model moved, enlarged or stretched into the canonical frame."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Bool, Float

from ....robot_model import Joint, Link, RobotModel, Visual, link_transforms
from ....types import Mesh


def transformed(mesh: Mesh, A: Float[np.ndarray, "3 3"], t: Float[np.ndarray, "3"]) -> Mesh:
    """The mesh under p -> A p + t; normals follow, faces turn over under a mirroring."""
    vertices = (mesh.vertices.astype(np.float64) @ A.T + t).astype(np.float32)
    normals = mesh.normals
    if normals is not None:
        turned = normals.astype(np.float64) @ np.linalg.inv(A)
        length = np.maximum(np.linalg.norm(turned, axis=1, keepdims=True), 1e-12)
        normals = (turned / length).astype(np.float32)
    moved = dataclasses.replace(mesh, vertices=vertices, normals=normals)
    return moved if np.linalg.det(A) > 0 else reversed_faces(moved, np.ones(len(mesh.faces), bool))


def reversed_faces(mesh: Mesh, flip: Bool[np.ndarray, " faces"]) -> Mesh:
    """The mesh with the marked faces wound the other way; their normals no longer hold."""
    faces = np.where(flip[:, None], mesh.faces[:, ::-1], mesh.faces)
    uv = mesh.uv
    if uv is not None:
        uv = np.where(flip[:, None, None], uv[:, ::-1], uv)
    return dataclasses.replace(mesh, faces=faces, uv=uv, normals=None)


def with_root_moved(
    robot: RobotModel, scale: float, R: Float[np.ndarray, "3 3"], t: Float[np.ndarray, "3"]
) -> RobotModel:
    """The robot enlarged, then turned and shifted: its root frame is the new frame.

    Masses stay as they are: a unit of length says nothing about kilograms. Centres of mass and
    inertias follow.
    """
    root = robot.links[0].name
    links = [
        _moved_link(link, scale, *((R, t) if link.name == root else (np.eye(3), np.zeros(3))))
        for link in robot.links
    ]
    joints = [_moved_joint(j, scale, R if j.parent == root else None, t) for j in robot.joints]
    return RobotModel(robot.name, tuple(links), tuple(joints))


def _moved_link(link: Link, scale: float, R: np.ndarray, t: np.ndarray) -> Link:
    A = scale * R
    return dataclasses.replace(
        link,
        visuals=tuple(dataclasses.replace(v, mesh=transformed(v.mesh, A, t)) for v in link.visuals),
        hulls=tuple(transformed(hull, A, t) for hull in link.hulls),
        com=A @ link.com + t,
        inertia=scale**2 * R @ link.inertia @ R.T,
    )


def _moved_joint(joint: Joint, scale: float, R: np.ndarray | None, t: np.ndarray) -> Joint:
    T = np.array(joint.T_parent_child, np.float64)
    T[:3, 3] *= scale
    if R is not None:
        move = np.eye(4)
        move[:3, :3], move[:3, 3] = R, t
        T = move @ T
    slide = scale if joint.kind == "prismatic" else 1.0
    return dataclasses.replace(
        joint, T_parent_child=T, lower=joint.lower * slide, upper=joint.upper * slide
    )


def stretched(robot: RobotModel, A: Float[np.ndarray, "3 3"]) -> RobotModel:
    """A robot without moving joints as one link under p -> A p, which may differ by axis."""
    poses = link_transforms(robot)
    visuals: list[Visual] = []
    hulls: list[Mesh] = []
    for link in robot.links:
        T = poses[link.name]
        B, t = A @ T[:3, :3], A @ T[:3, 3]
        visuals += [
            dataclasses.replace(v, mesh=transformed(v.mesh, B, t), name=_name(robot, link, v))
            for v in link.visuals
        ]
        hulls += [transformed(hull, B, t) for hull in link.hulls]
    root = robot.links[0]
    one = Link(
        root.name,
        tuple(visuals),
        tuple(hulls),
        robot.mass_kg,
        np.zeros(3),
        np.zeros((3, 3)),
        root.friction,
    )
    return RobotModel(robot.name, (one,), ())


def _name(robot: RobotModel, link: Link, visual: Visual) -> str:
    return visual.name if len(robot.links) == 1 else f"{link.name}_{visual.name}"
