"""What a model's numbers alone must fulfil: hulls, inertia, joints (planes: `check_planes`).

Every function gives the reasons why a model fails, none where it is sound.
"""

from __future__ import annotations

import itertools

import numpy as np

from ...classes import class_named
from ...library import CadModel
from ...robot_model import Joint, Link, RobotModel
from ...types import Mesh
from .settings import CheckSettings

_UNIT = 1e-5
"""How far the length of a direction may be from 1."""
_MANY = 3
"""Reasons of one kind that are listed; the rest is counted."""


def hull_faults(model: CadModel, settings: CheckSettings) -> list[str]:
    """Hulls that are not closed, convex, small, or reach out of what is seen."""
    found = []
    for link in model.robot.links:
        for i, hull in enumerate(link.hulls):
            wrong = hull_problem(hull, settings)
            if wrong:
                found.append(f"hull {i} of {link.name} {wrong}")
        found += _reach(link, model.swelling_m + settings.flat_m)
    if not any(link.hulls for link in model.robot.links):
        found.append("no link has a collision hull")
    return shortened(found)


def hull_problem(hull: Mesh, settings: CheckSettings) -> str:
    """Why a mesh is no convex hull; empty where it is one."""
    if len(hull.vertices) > settings.max_hull_vertices:
        return f"has {len(hull.vertices)} vertices, more than {settings.max_hull_vertices}"
    if not np.isfinite(hull.vertices).all():
        return "has coordinates that are no numbers"
    if not _closed(hull):
        return "is not closed"
    corners = hull.vertices.astype(np.float64)[hull.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(normal, axis=1) / 2
    if np.einsum("fc,fc->", corners[:, 0], normal) <= 0:
        return "is inside out or flat"
    large = area > 1e-10  # slivers have no normal to speak of
    unit = normal[large] / (2 * area[large, None])
    height = np.einsum("fc,fvc->fv", unit, hull.vertices - corners[large, :1])
    bulge = float(height.max(initial=0.0))
    return f"is not convex by {1000 * bulge:.3f} mm" if bulge > settings.flat_m else ""


def _closed(mesh: Mesh) -> bool:
    """Whether every edge lies between two faces that run along it in opposite directions."""
    _, corner = np.unique(mesh.vertices, axis=0, return_inverse=True)
    edges = corner.ravel()[mesh.faces][:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2)
    there = {tuple(edge) for edge in edges.tolist()}
    return len(there) == len(edges) and all((b, a) in there for a, b in there)


def _reach(link: Link, allowed_m: float) -> list[str]:
    """Where hulls leave the box of the link's visuals by more than is allowed."""
    if not link.hulls or not link.visuals:
        return []
    hulls = np.concatenate([hull.vertices for hull in link.hulls])
    seen = np.concatenate([visual.mesh.vertices for visual in link.visuals])
    beyond = max(
        float((hulls.max(0) - seen.max(0)).max()), float((seen.min(0) - hulls.min(0)).max())
    )
    if beyond <= allowed_m:
        return []
    return [f"hulls of {link.name} reach {1000 * beyond:.1f} mm out of what is seen of it"]


def inertia_faults(model: CadModel, settings: CheckSettings) -> list[str]:
    """Masses and inertias that no body has, or no thing of this class."""
    found = [
        f"{link.name}: {wrong}" for link in model.robot.links if (wrong := inertia_problem(link))
    ]
    filled = class_named(model.class_name).density_kg_m3 * float(np.prod(model.size))
    mass, factor = model.robot.mass_kg, settings.density_factor
    if not filled / factor <= mass <= filled * factor:
        low, high = (f"{filled * f:.3g}" for f in (1 / factor, factor))
        found.append(f"{mass:.3g} kg, where a {model.class_name} of its size has {low}..{high} kg")
    return shortened(found)


def inertia_problem(link: Link) -> str:
    """Why no body has the link's mass and inertia; empty where one may."""
    inertia = np.asarray(link.inertia, np.float64)
    if not link.mass_kg > 0:
        return f"mass {link.mass_kg:g} kg"
    if not np.isfinite(inertia).all() or not np.allclose(inertia, inertia.T, rtol=1e-6, atol=1e-12):
        return "inertia is not symmetric"
    moments = np.linalg.eigvalsh(inertia)
    if not moments[0] > 0:
        return f"least moment of inertia {moments[0]:.3g} kg m^2"
    if moments[0] + moments[1] < moments[2] * (1 - 1e-6):
        return f"moments {', '.join(f'{v:.3g}' for v in moments)} break the triangle inequality"
    points = [m.vertices for m in (*link.hulls, *(v.mesh for v in link.visuals))]
    if points:
        cloud = np.concatenate(points)
        if np.any(link.com < cloud.min(0)) or np.any(link.com > cloud.max(0)):
            return "its centre of mass lies outside of it"
    return ""


def joint_faults(model: CadModel, settings: CheckSettings) -> list[str]:
    """Joints with limits, axes, losses or handles that cannot be right."""
    robot, named = model.robot, {handle.joint: handle for handle in model.handles}
    found = _tree_problems(robot)
    if tuple(joint.name for joint in robot.moving_joints) != model.moving_joints:
        found.append(f"stated joints {model.moving_joints} are not those of the links")
    for joint in robot.moving_joints:
        found += [f"{joint.name}: {wrong}" for wrong in _joint_problems(joint)]
        if joint.name not in named:
            found.append(f"{joint.name}: no handle is named for it")
    for handle in model.handles:
        links = {joint.name: _moved_links(robot, joint.child) for joint in robot.moving_joints}
        if handle.joint not in links:
            found.append(f"a handle is named for the unknown joint {handle.joint}")
        elif handle.link not in links[handle.joint]:
            found.append(f"{handle.joint}: its handle is on {handle.link}, which it does not move")
        elif (off := _distance_to(robot.link(handle.link), handle.position)) > settings.handle_m:
            found.append(f"{handle.joint}: its handle is {1000 * off:.0f} mm off {handle.link}")
    return shortened(found)


def _tree_problems(robot: RobotModel) -> list[str]:
    names = [link.name for link in robot.links]
    found = []
    for kind, called in (("links", names), ("joints", [joint.name for joint in robot.joints])):
        doubled = sorted({name for name in called if called.count(name) > 1})
        found += [f"two {kind} are called {name}" for name in doubled]
    reached = {names[0]}
    for _ in robot.joints:
        reached |= {joint.child for joint in robot.joints if joint.parent in reached}
    return found + [f"link {name} hangs on no joint" for name in names if name not in reached]


def _joint_problems(joint: Joint) -> list[str]:
    found = []
    if abs(float(np.linalg.norm(joint.axis)) - 1) > _UNIT:
        found.append(f"axis {np.round(joint.axis, 4).tolist()} is not of length 1")
    if joint.kind != "continuous" and not joint.lower <= 0 <= joint.upper:
        found.append(f"limits {joint.lower:g}..{joint.upper:g} do not contain 0 (closed)")
    if joint.kind != "continuous" and not joint.lower < joint.upper:
        found.append(f"limits {joint.lower:g}..{joint.upper:g} leave no range")
    if joint.damping < 0 or joint.friction < 0:
        found.append(f"damping {joint.damping:g} and friction {joint.friction:g} must be >= 0")
    return found


def _moved_links(robot: RobotModel, child: str) -> set[str]:
    """The child of a joint and all that hangs on it."""
    moved = {child}
    for _ in robot.joints:
        moved |= {joint.child for joint in robot.joints if joint.parent in moved}
    return moved


def _distance_to(link: Link, point: np.ndarray) -> float:
    """From a point to the nearest box about one of the link's bodies, metres."""
    meshes = (*link.hulls, *(visual.mesh for visual in link.visuals))
    if not meshes:
        return np.inf
    low = np.array([mesh.vertices.min(0) for mesh in meshes])
    high = np.array([mesh.vertices.max(0) for mesh in meshes])
    outside = np.maximum(0, np.maximum(low - point, point - high))
    return float(np.linalg.norm(outside, axis=1).min())


def shortened(reasons: list[str]) -> list[str]:
    """The first few reasons and how many more there are."""
    rest = len(reasons) - _MANY
    kept = list(itertools.islice(reasons, _MANY))
    return kept + ([f"and {rest} more"] if rest > 0 else [])
