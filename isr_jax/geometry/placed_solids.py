"""Solids where they stand: their deepest overlap, what of it is contact, and the way out of it."""

from __future__ import annotations

import dataclasses
import functools

import numpy as np
from jaxtyping import Float

from .convex import ConvexPart, penetration, shifted_part, sideways_exit, vertical_gap

CONTACT_LIFT_M = 0.03
"""An overlap of a thing with what carries it is contact if so small a lift ends it: carrying planes
are a little uneven, and collision hulls reach a little beyond them. What needs more of a lift, as a
backrest does, the thing has to leave sideways."""


@dataclasses.dataclass(frozen=True, eq=False)
class PlacedSolid:
    """The convex parts of a thing, world frame."""

    unmoved: tuple[ConvexPart, ...]
    """The parts where the solid was put first."""
    swelling_m: float = 0.0
    """How far the parts may reach beyond those that will be written in their place; 0: they are
    those."""
    shift_m: Float[np.ndarray, "3"] = dataclasses.field(default_factory=lambda: np.zeros(3))
    """From there to where it stands."""

    @functools.cached_property
    def parts(self) -> tuple[ConvexPart, ...]:
        """The parts where the solid stands."""
        return tuple(self.part(i) for i in range(len(self.unmoved)))

    def part(self, i: int) -> ConvexPart:
        """One of `parts`, without the others: most parts are far from everything."""
        part = self.unmoved[i]
        return shifted_part(part, self.shift_m) if np.any(self.shift_m) else part

    @functools.cached_property
    def lows(self) -> Float[np.ndarray, "parts 3"]:
        return np.array([part.low for part in self.unmoved]) + self.shift_m

    @functools.cached_property
    def highs(self) -> Float[np.ndarray, "parts 3"]:
        return np.array([part.high for part in self.unmoved]) + self.shift_m

    @functools.cached_property
    def low(self) -> Float[np.ndarray, "3"]:
        return self.lows.min(0)

    @functools.cached_property
    def high(self) -> Float[np.ndarray, "3"]:
        return self.highs.max(0)

    @property
    def bottom_m(self) -> float:
        """Height at which it stands."""
        return float(self.low[2])

    def moved(self, step_m: Float[np.ndarray, "3"]) -> PlacedSolid:
        """The same solid, shifted."""
        if not np.any(step_m):
            return self
        return dataclasses.replace(self, shift_m=self.shift_m + step_m)


@dataclasses.dataclass(frozen=True, eq=False)
class PartOverlap:
    """Two parts that overlap."""

    depth_m: float
    part: ConvexPart
    other: ConvexPart

    def way_out(self) -> tuple[float, Float[np.ndarray, "3"]]:
        """Shortest horizontal move of the first part: its length (inf: none), unit direction."""
        return sideways_exit(self.part, self.other)


def deepest_overlap(
    a: PlacedSolid, b: PlacedSolid, *, carried: bool = False, least_m: float = 0.0
) -> PartOverlap | None:
    """The deepest pair of parts that overlap by more than ``least_m``; None where none does.

    Args:
        a: A solid.
        b: Another one.
        carried: ``a`` stands on ``b``: parts that touch are left out (`is_contact`).
        least_m: Depth that does not count.
    """
    found = None
    lift_m = CONTACT_LIFT_M + a.swelling_m + b.swelling_m
    for i, j, bound_m in _near_pairs(a, b):
        if bound_m <= least_m:
            break  # the boxes of all that follow overlap by less
        part, other = a.part(i), b.part(j)
        depth_m, _ = penetration(part, other)
        if depth_m <= least_m or (carried and is_contact(part, other, lift_m)):
            continue
        found, least_m = PartOverlap(depth_m, part, other), depth_m
    return found


def is_contact(part: ConvexPart, carrier: ConvexPart, lift_m: float = CONTACT_LIFT_M) -> bool:
    """Whether a small lift of a part that stands on another parts the two, which overlap."""
    return vertical_gap(part, carrier) >= -lift_m


def _near_pairs(a: PlacedSolid, b: PlacedSolid) -> list[tuple[int, int, float]]:
    """Pairs of parts whose boxes meet, and by how much: no overlap is deeper. Largest first."""
    if np.any(a.low > b.high) or np.any(b.low > a.high):
        return []
    overlap_m = np.minimum(a.highs[:, None] - b.lows, b.highs - a.lows[:, None]).min(2)
    pairs = np.argwhere(overlap_m > 0)
    bounds = overlap_m[pairs[:, 0], pairs[:, 1]]
    order = np.argsort(-bounds, kind="stable")
    return [(i, j, m) for (i, j), m in zip(pairs[order].tolist(), bounds[order].tolist())]
