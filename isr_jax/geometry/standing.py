"""Things that stand on each other: what is moved takes along what it carries."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from typing import Any, Generic, Protocol, TypeVar, runtime_checkable

import numpy as np
from jaxtyping import Float, Int

from .placed_solids import PartOverlap


@runtime_checkable
class Movable(Protocol):
    """What can be shifted."""

    def moved(self, step_m: Float[np.ndarray, "3"]) -> Any:
        """The same thing elsewhere."""


class SupportTree:
    """Who stands on whom, by position."""

    def __init__(self, parent: Int[np.ndarray, " things"], fixed: Collection[int] = ()) -> None:
        """Args: parent: Of each; negative where nothing carries it. fixed: What stays where it is
        when what carries it is moved."""
        self.parent = np.asarray(parent)
        self.fixed = frozenset(fixed)

    def stands_on(self, child: int, carrier: int) -> bool:
        """Whether one stands on the other, with nothing between."""
        return int(self.parent[child]) == carrier

    def subtree(self, i: int) -> list[int]:
        """What moves with a thing: itself, and all that stands on it."""
        found = [i]
        for k in found:
            children = np.flatnonzero(self.parent == k).tolist()
            found += [c for c in children if c not in self.fixed]
        return found

    def carriers(self, i: int) -> list[int]:
        """What a thing stands on, what that stands on, and so on."""
        found = []
        while (i := int(self.parent[i])) >= 0:
            found.append(i)
        return found

    def top_down(self, things: Iterable[int]) -> list[int]:
        """The things, carriers before what they carry, then by position."""
        return sorted(things, key=lambda i: (len(self.carriers(i)), i))


T = TypeVar("T", bound=Movable)


class StandingThings(Generic[T]):
    """Things at their places while some of them are moved."""

    def __init__(self, tree: SupportTree, things: Mapping[int, T]) -> None:
        self.tree = tree
        self.things: dict[int, T] = dict(things)
        self.shift_m: dict[int, Float[np.ndarray, "3"]] = {i: np.zeros(3) for i in things}
        """Of each, from where it was put."""

    def move(self, i: int, step_m: Float[np.ndarray, "3"]) -> None:
        """Shift a thing with all that it carries."""
        for k in self.tree.subtree(i):
            self.shift_m[k] = self.shift_m[k] + step_m
            self.things[k] = self.things[k].moved(step_m)

    def step_out(
        self, i: int, overlap: PartOverlap, *, gap_m: float, farthest_m: float
    ) -> Float[np.ndarray, "3"] | None:
        """The shortest sideways step that takes a thing out of an overlap of it.

        Args:
            i: The thing that ``overlap.part`` is of.
            overlap: To be left.
            gap_m: Left beyond it.
            farthest_m: From where the thing was put; None where it would end farther away.
        """
        length_m, direction = overlap.way_out()
        if not np.isfinite(length_m):
            return None
        step_m = direction * (length_m + gap_m)
        return step_m if np.linalg.norm(self.shift_m[i] + step_m) <= farthest_m else None

    def places(self) -> tuple[dict[int, T], dict[int, np.ndarray]]:
        """Where everything is, for `put_back`."""
        return dict(self.things), dict(self.shift_m)

    def put_back(self, places: tuple[dict[int, T], dict[int, np.ndarray]]) -> None:
        """Undo all moves since `places`."""
        self.things, self.shift_m = dict(places[0]), dict(places[1])
