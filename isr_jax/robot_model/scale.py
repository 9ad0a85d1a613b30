"""A model at another size: everything that has a length in it follows."""

from __future__ import annotations

import dataclasses

import numpy as np

from ..errors import SettingError
from ..types import Mesh
from .model import Joint, Link, RobotModel


def scaled(model: RobotModel, alpha: float) -> RobotModel:
    """The model enlarged ``alpha`` times in all directions, of the same materials.

    Meshes, joint origins, slide ranges and centres of mass grow by alpha, masses by alpha^3,
    inertias by alpha^5. Angles, damping and friction stay. Three different factors would shear
    the hinges, so there is one.

    Raises:
        SettingError: ``alpha`` is not positive and finite.
    """
    if not (np.isfinite(alpha) and alpha > 0):
        raise SettingError(f"scale {alpha!r} of {model.name}", "give a positive, finite factor")
    if alpha == 1.0:
        return model
    return RobotModel(
        model.name,
        tuple(_scaled_link(link, alpha) for link in model.links),
        tuple(_scaled_joint(joint, alpha) for joint in model.joints),
    )


def _scaled_mesh(mesh: Mesh, alpha: float) -> Mesh:
    vertices = (mesh.vertices.astype(np.float64) * alpha).astype(mesh.vertices.dtype)
    return dataclasses.replace(mesh, vertices=vertices)


def _scaled_link(link: Link, alpha: float) -> Link:
    return dataclasses.replace(
        link,
        visuals=tuple(
            dataclasses.replace(v, mesh=_scaled_mesh(v.mesh, alpha)) for v in link.visuals
        ),
        hulls=tuple(_scaled_mesh(hull, alpha) for hull in link.hulls),
        mass_kg=link.mass_kg * alpha**3,
        com=link.com * alpha,
        inertia=link.inertia * alpha**5,
    )


def _scaled_joint(joint: Joint, alpha: float) -> Joint:
    T = np.array(joint.T_parent_child, np.float64)
    T[:3, 3] *= alpha
    slide = alpha if joint.kind == "prismatic" else 1.0
    return dataclasses.replace(
        joint, T_parent_child=T, lower=joint.lower * slide, upper=joint.upper * slide
    )
