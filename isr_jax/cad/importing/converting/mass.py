"""Masses and inertias of imported links.

Stated masses hold where they make a body of plausible density. Otherwise the whole weighs its
class's density times its filled volume: what no level or upright look along the axes passes
through. Links share it by their surfaces. Inertia is that of the seen surface as a shell of even
thickness, scaled to the mass.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float

from ....borders.raycast import RayScene
from ....classes import class_named
from ....robot_model import Link, RobotModel
from ....types import Mesh
from .skin import Skin

_GRID = 40
_DENSITY_FACTOR = 8.0
"""Stated masses within this factor of the estimated one are believed."""
_HOLLOW = frozenset(
    [
        "cabinet",
        "wall_cabinet",
        "drawer_unit",
        "wardrobe",
        "nightstand",
        "counter",
        "fridge",
        "oven",
        "dishwasher",
        "washing_machine",
    ]
)
_HOLLOW_SHARE = 0.55
"""Closed carcasses of the kit weigh so much of their class's density times their volume."""
_MIN_MASS_KG = 1e-3
_THICKNESS_M = 0.003
"""Of the shell: it only keeps flat links from having no inertia across."""
_INERTIA_FACTOR = 5.0
"""A stated inertia that is this many times the shell's is a placeholder."""
_FRICTION = {"cup": 0.4, "bowl": 0.4, "vase": 0.4, "sofa": 0.6, "bed": 0.6, "cushion": 0.6}
_USUAL_FRICTION = 0.5


def with_masses(
    robot: RobotModel, skin: Skin, class_name: str, total_kg: float | None
) -> tuple[RobotModel, str]:
    """The robot with sound masses, inertias and friction, and what was estimated (or nothing).

    Args:
        skin: Of the robot, canonical frame.
        total_kg: Stated mass of the whole.
    """
    fill = _HOLLOW_SHARE if class_name in _HOLLOW else 1.0
    estimate = fill * class_named(class_name).density_kg_m3 * filled_volume(skin)
    stated = sum(link.mass_kg for link in robot.links)
    shares = _surface_shares(robot, skin)
    bound = _DENSITY_FACTOR
    if all(link.mass_kg > 0 or share == 0 for link, share in zip(robot.links, shares)) and (
        estimate / bound <= stated <= estimate * bound
    ):
        masses, note = [link.mass_kg for link in robot.links], ""
    elif total_kg is not None and total_kg > 0:
        masses, note = list(total_kg * shares), ""
        if len(robot.links) > 1:
            note = "stated mass shared among the links by surface"
    else:
        masses = list(max(estimate, _MIN_MASS_KG) * shares)
        said = f" (stated: {stated:.3g} kg)" if stated > 0 else ""
        note = f"mass estimated from class and volume: {sum(masses):.3g} kg{said}"
    links = [
        _with_mass(link, max(m, _MIN_MASS_KG), class_name) for link, m in zip(robot.links, masses)
    ]
    return dataclasses.replace(robot, links=tuple(links)), note


def filled_volume(skin: Skin) -> float:
    """Volume of the points that the surface hides along x, y and z, m^3.

    A cell counts where it lies between the first and the last surface on the lines through it
    along all three axes: closed bodies are full, a shelf and what is under a table are not.
    """
    low, size = skin.vertices.min(0), np.maximum(skin.size, 1e-4)
    steps = (np.arange(_GRID) + 0.5) / _GRID
    inside = np.ones((_GRID,) * 3, bool)
    for axis in range(3):
        first, last = _first_and_last(skin.rays, low, size, axis, steps)
        depth = steps * size[axis]
        span = (depth >= first[..., None]) & (depth <= last[..., None])
        inside &= np.moveaxis(span, -1, axis)
    shell = float(skin.area.sum()) * _THICKNESS_M / 2
    return max(float(inside.mean() * size.prod()), min(shell, float(size.prod())))


def _first_and_last(
    rays: RayScene, low: np.ndarray, size: np.ndarray, axis: int, steps: np.ndarray
) -> tuple[np.ndarray, np.ndarray]:
    """Depth from the low side of the first and last skin, [grid, grid] over the other axes."""
    others = [k for k in range(3) if k != axis]
    u, v = np.meshgrid(steps, steps, indexing="ij")
    origins = np.zeros((u.size, 3))
    origins[:, others[0]] = low[others[0]] + size[others[0]] * u.ravel()
    origins[:, others[1]] = low[others[1]] + size[others[1]] * v.ravel()
    origins[:, axis] = low[axis] - size[axis]
    direction = np.tile(np.eye(3)[axis], (u.size, 1))
    ahead = rays.cast(origins, direction)
    origins[:, axis] = low[axis] + 2 * size[axis]
    behind = rays.cast(origins, -direction)
    hit = (ahead.triangle >= 0) & (behind.triangle >= 0)
    first = np.where(hit, ahead.distance - size[axis], np.inf)
    last = np.where(hit, 2 * size[axis] - behind.distance, -np.inf)
    return first.reshape(u.shape), last.reshape(u.shape)


def _surface_shares(robot: RobotModel, skin: Skin) -> np.ndarray:
    """Part of the whole surface that each link has."""
    area = np.bincount(skin.link, skin.area, len(robot.links))
    return area / area.sum()


def _with_mass(link: Link, mass_kg: float, class_name: str) -> Link:
    com, inertia = _shell(link, mass_kg)
    if _is_sound(link, mass_kg, inertia):
        com, inertia = link.com, link.inertia
    friction = _FRICTION.get(class_name, _USUAL_FRICTION)
    return dataclasses.replace(
        link, mass_kg=float(mass_kg), com=com, inertia=inertia, friction=friction
    )


def _is_sound(link: Link, mass_kg: float, shell: np.ndarray) -> bool:
    """Whether the stated mass properties can be those of the link's shape."""
    if link.mass_kg != mass_kg or not np.all(np.isfinite(link.inertia)):
        return False
    moments = np.linalg.eigvalsh((link.inertia + link.inertia.T) / 2)
    ratio = np.trace(link.inertia) / np.trace(shell)
    points = np.concatenate([np.zeros((0, 3)), *(m.vertices for m in _meshes(link))])
    return bool(
        moments[0] > 0
        and moments[0] + moments[1] >= moments[2] * (1 - 1e-6)
        and 1 / _INERTIA_FACTOR <= ratio <= _INERTIA_FACTOR
        and len(points)
        and np.all((link.com >= points.min(0)) & (link.com <= points.max(0)))
    )


def _meshes(link: Link) -> list[Mesh]:
    return [visual.mesh for visual in link.visuals] or list(link.hulls)


def _shell(link: Link, mass_kg: float) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3 3"]]:
    """Centre of mass and inertia about it of the surface as a thin shell.

    The second moment of a triangle of area A with corners v is A/12 (sum v v^T + s s^T), s = sum v.
    """
    meshes = _meshes(link)
    corners = np.concatenate(
        [np.zeros((0, 3, 3)), *(m.vertices.astype(np.float64)[m.faces] for m in meshes)]
    )
    cross = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    area = np.linalg.norm(cross, axis=1) / 2
    least = mass_kg * _THICKNESS_M**2 / 6 * np.eye(3)
    if not area.sum() > 0:
        return np.zeros(3), least
    total = corners.sum(1)
    com = area @ total / 3 / area.sum()
    corners = corners - com
    total = corners.sum(1)
    second = np.einsum("f,fic,fid->cd", area, corners, corners)
    second += np.einsum("f,fc,fd->cd", area, total, total)
    second *= mass_kg / (12 * area.sum())
    inertia = np.trace(second) * np.eye(3) - second + least
    return com, (inertia + inertia.T) / 2
