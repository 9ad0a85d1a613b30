"""The steps of which a kind of room is made. Roles in a tuple: the first that the library has."""

from __future__ import annotations

import dataclasses

Roles = tuple[str, ...]
Count = tuple[int, int]
"""Least and most, both possible."""
Span = tuple[float, float]


@dataclasses.dataclass(frozen=True)
class Run:
    """Units side by side along one wall, and what hangs above them."""

    units: tuple[Roles, ...]
    above: Roles = ()
    must: bool = True
    """A room without it is begun again."""


@dataclasses.dataclass(frozen=True)
class Seating:
    """A table in the room with seats around it, some pushed under it."""

    table: Roles
    seats: Roles
    count: Count
    turn_rad: float = 0.35
    """Most by which the table is turned off the walls."""
    long_sides_only: bool = False
    must: bool = True


@dataclasses.dataclass(frozen=True)
class Workplace:
    """A desk at a wall and a chair before it."""

    desk: Roles
    chair: Roles
    count: Count = (1, 1)
    must: bool = True


@dataclasses.dataclass(frozen=True)
class Sleeping:
    """A bed with its head at a wall, and a stand on either side."""

    bed: Roles
    stands: Roles
    must: bool = True


@dataclasses.dataclass(frozen=True)
class Lounge:
    """A sofa at a wall, a low table before it, a seat beside that, a bench across the room."""

    sofa: Roles
    table: Roles
    seat: Roles
    bench: Roles
    must: bool = True


@dataclasses.dataclass(frozen=True)
class AtWall:
    """Single things with their backs to any wall."""

    roles: Roles
    count: Count = (1, 1)
    front_m: float = 0.1
    """Space that stays clear before them."""


@dataclasses.dataclass(frozen=True)
class OnWall:
    """Things fixed to a wall."""

    roles: Roles
    count: Count = (1, 1)
    low_m: Span = (1.3, 1.6)
    """Height of the lower edge."""
    near: Roles = ()
    """Beside one of these on its wall; anywhere without."""


@dataclasses.dataclass(frozen=True)
class FromCeiling:
    """Hangs from the ceiling, over one of these where there is one."""

    roles: Roles
    over: Roles = ()


@dataclasses.dataclass(frozen=True)
class OnFloor:
    """Lies anywhere on the free floor."""

    roles: Roles
    count: Count = (1, 1)


@dataclasses.dataclass(frozen=True)
class OnTop:
    """Things on other things: ``roles`` in any order."""

    hosts: Roles
    roles: Roles
    count: Count = (1, 1)
    at: tuple[float | None, float | None] = (None, None)
    """Where about on the host's rectangle, -1 to 1 to its right and to its back; None anywhere."""
    each: bool = False
    """So many on every host, not in all."""


@dataclasses.dataclass(frozen=True)
class Stack:
    """One thing on the other; nothing of a level stands without the level below."""

    hosts: Roles
    levels: tuple[Roles, ...]
    count: Count = (1, 1)


@dataclasses.dataclass(frozen=True)
class LeanOnWall:
    """Flat things that stand on the floor and lean on a wall."""

    roles: Roles
    count: Count = (1, 1)


@dataclasses.dataclass(frozen=True)
class LeanOnTop:
    """Flat things that stand on a host and lean on its side, or on the wall behind it."""

    hosts: Roles
    roles: Roles
    count: Count = (1, 1)


Group = Run | Seating | Workplace | Sleeping | Lounge
Single = AtWall | OnWall | FromCeiling | OnFloor | OnTop | Stack | LeanOnWall | LeanOnTop
Step = Group | Single


@dataclasses.dataclass(frozen=True)
class Recipe:
    """One kind of room."""

    width_m: Span
    depth_m: Span
    height_m: Span
    needs: tuple[Roles, ...]
    """Without one of each, there is no such room."""
    steps: tuple[Step, ...]
    """In the order in which they need space."""


def roles_of(step: Step) -> Roles:
    """All roles of which a step places models."""
    match step:
        case Run():
            return (*(role for roles in step.units for role in roles), *step.above)
        case Seating():
            return (*step.table, *step.seats)
        case Workplace():
            return (*step.desk, *step.chair)
        case Sleeping():
            return (*step.bed, *step.stands)
        case Lounge():
            return (*step.sofa, *step.table, *step.seat, *step.bench)
        case Stack():
            return tuple(role for roles in step.levels for role in roles)
        case _:
            return step.roles
