"""Masses and inertias that a robot file states: those that no real body can have are dropped."""

from __future__ import annotations

import dataclasses

import numpy as np

from ....robot_model import Link

_MIN_DENSITY, _MAX_DENSITY = 1.0, 25_000.0
"""Of a link's bounding box, kg/m^3: foam packaging is 10, gold 19,300; frames are mostly air."""
_GYRATION = 0.51
"""Largest radius of gyration in bounding-box diagonals: that of two points at its ends is 0.5."""


def believable(links: list[Link], notes: list[str]) -> list[Link]:
    """The links, without masses and inertias that cannot be true; ``notes`` says which.

    Args:
        links: As their file states them.
        notes: Gets a line for each kind of fault.
    """
    stated = [link for link in links if link.mass_kg != 0 or np.any(link.inertia)]
    if _placeholders(stated):
        link = stated[0]
        said = f"the same placeholder mass ({link.mass_kg:g} kg) and inertia everywhere"
        notes.append(f"{said}: dropped")
        return [without_mass(link) for link in links]
    dropped: dict[str, list[str]] = {}
    kept = []
    for link in links:
        fault = "" if link not in stated else _fault(link)
        if fault:
            dropped.setdefault(fault, []).append(link.name)
        kept.append(without_mass(link) if fault else link)
    notes += [f"mass of {', '.join(names)} dropped: {fault}" for fault, names in dropped.items()]
    return kept


def without_mass(link: Link) -> Link:
    """The link as if its file stated no mass."""
    return dataclasses.replace(link, mass_kg=0.0, com=np.zeros(3), inertia=np.zeros((3, 3)))


def _placeholders(stated: list[Link]) -> bool:
    if len(stated) < 3:
        return False
    first = stated[0]
    return all(
        link.mass_kg == first.mass_kg and np.array_equal(link.inertia, first.inertia)
        for link in stated
    )


def _fault(link: Link) -> str:
    """What is wrong with a stated mass, or nothing."""
    if not (np.isfinite(link.mass_kg) and link.mass_kg > 0):
        return "it is not positive"
    if not (np.all(np.isfinite(link.inertia)) and np.all(np.isfinite(link.com))):
        return "its numbers are not finite"
    moments = np.linalg.eigvalsh((link.inertia + link.inertia.T) / 2)
    if moments[0] <= 0 or moments[2] > (moments[0] + moments[1]) * (1 + 1e-6):
        return "its inertia is that of no body"
    size = _size(link)
    if size is None:
        return ""
    if np.sqrt(moments[2] / link.mass_kg) > _GYRATION * np.linalg.norm(size):
        return "its inertia is far too large for its shape"
    density = link.mass_kg / np.prod(np.maximum(size, 0.001))
    if not _MIN_DENSITY <= density <= _MAX_DENSITY:
        return f"no material has {density:.2g} kg/m^3"
    return ""


def _size(link: Link) -> np.ndarray | None:
    meshes = [visual.mesh for visual in link.visuals] or list(link.hulls)
    if not meshes:
        return None
    points = np.concatenate([mesh.vertices for mesh in meshes])
    return np.ptp(points, axis=0)
