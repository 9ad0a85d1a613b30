"""Round things as made on a lathe or blown: stacks of frusta, and hollow walls of staves.

A profile lists (height, radius) pairs from below; ``squeeze`` is the depth over the width of what
is oval. What is seen of neighbouring pieces is one closed skin: the faces between them are hidden.
"""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Sequence

import numpy as np

from ....errors import SettingError
from ..solids import ROUND_SIDES, Solid, circle, frustum, tube

Profile = Sequence[tuple[float, float]]
_BELOW, _ABOVE = 0, 1
"""Faces of a stave that touch the ring below and above."""


def stack(
    profile: Profile,
    *,
    squeeze: float = 1.0,
    sides: int = ROUND_SIDES,
    center: tuple[float, float] = (0.0, 0.0),
) -> tuple[Solid, ...]:
    """A solid of revolution: one frustum between each two heights of the profile.

    Raises:
        SettingError: A radius is not positive.
    """
    _refuse_empty(r for _, r in profile)
    last, pieces = len(profile) - 2, []
    for k, ((z0, r0), (z1, r1)) in enumerate(itertools.pairwise(profile)):
        radii = ((r0, r0 * squeeze), (r1, r1 * squeeze))
        touching = ({sides} if k else set()) | ({sides + 1} if k < last else set())
        piece = frustum(radii, (z0, z1), center, sides)
        pieces.append(dataclasses.replace(piece, hidden=frozenset(touching)))
    return tuple(pieces)


def shell(
    profile: Profile,
    inner: Sequence[float],
    *,
    squeeze: float = 1.0,
    sides: int = ROUND_SIDES,
    center: tuple[float, float] = (0.0, 0.0),
) -> tuple[Solid, ...]:
    """A wall around a hollow: one ring of staves between each two heights of the profile.

    Args:
        profile: Heights and outer radii.
        inner: Inner radius at each height, less than the outer one.
        squeeze: Depth over width.
        sides: Staves per ring.
        center: Of the axis.

    Raises:
        SettingError: A radius or the wall between two is not positive.
    """
    _refuse_empty(inner)
    _refuse_empty(r - n for (_, r), n in zip(profile, inner, strict=True))
    last, staves = len(profile) - 2, []

    def outline(radius: float) -> np.ndarray:
        return circle((radius, radius * squeeze), sides, center)

    for k in range(last + 1):
        (z0, r0), (z1, r1) = profile[k], profile[k + 1]
        outer = np.stack([outline(r0), outline(r1)])
        hollow = np.stack([outline(inner[k]), outline(inner[k + 1])])
        touching = ({_BELOW} if k else set()) | ({_ABOVE} if k < last else set())
        staves += [
            dataclasses.replace(stave, hidden=stave.hidden | touching)
            for stave in tube(outer, hollow, (z0, z1), is_round=True)
        ]
    return tuple(staves)


def inner_radii(profile: Profile, wall: float) -> list[float]:
    """Radii [heights] inside a wall of even thickness, measured across the slope."""
    z, r = (np.array(column, np.float64) for column in zip(*profile))
    slope = np.gradient(r, z)
    return np.round(r - wall * np.sqrt(1 + slope**2), 6).tolist()


def rounds_of(width: float, depth: float) -> tuple[int, float]:
    """Symmetry (0 round, 2 oval) and squeeze of a round thing of this width and depth."""
    return (0 if width == depth else 2), depth / width


def _refuse_empty(radii) -> None:
    least = min(radii)
    if not least > 0:
        problem = f"a round part would have a radius or a wall of {least:.4g} m"
        raise SettingError(problem, "ask for a larger model, or give it a thinner wall or neck")
