"""A furnished room from a seed and the models of a library."""

from __future__ import annotations

import dataclasses

import numpy as np

from ...errors import LibraryError, SceneError, SettingError
from ...library import CadLibrary
from ..room import LayoutPatch, PlacedModel, Room, RoomKind, upright_from_gravity
from .floor_rules import place_at_walls, place_on_floor, place_run
from .groups import place_lounge, place_seating, place_sleeping, place_workplaces
from .hanging import hang_above_run, hang_from_ceiling, hang_on_walls
from .kinds import DEMONSTRATION, RECIPES
from .leaning import lean_on_tops, lean_on_walls
from .placement import Occupancy
from .proposal import ON_FLOOR, ON_NOTHING, Proposal, rotation_2d
from .recipe import (
    AtWall,
    FromCeiling,
    LeanOnTop,
    LeanOnWall,
    Lounge,
    OnFloor,
    OnTop,
    OnWall,
    Recipe,
    Run,
    Seating,
    Sleeping,
    Stack,
    Step,
    Workplace,
    roles_of,
)
from .roles import ROLES
from .shell import Shell, make_shell
from .stock import Stock
from .support_rules import place_on_tops, place_stacks

MIN_ITEMS = 8
"""Fewest things in a room, layout aside."""
BUILTIN_SEED = 8
_BUILTIN_KIND = "kitchen"
_BUILTIN_ROLES = ("fridge", "cooker", "wall cabinet", "dining table", "desk", "bookshelf", "book")
_ATTEMPTS = 40
_DEEPEST = 3
_STACK_ATTEMPTS = 8
"""After so many, a room in which nothing stands three supports deep will do."""


def make_room(
    seed: int, library: CadLibrary, *, kind: str | None = None, ceiling: bool = True
) -> Room:
    """A room furnished with models of ``library``: the same seed, the same room.

    Boxes keep 2 cm from each other, but for what carries, leans on or is pushed under another.
    Something stands three supports deep where the library has anything flat to stack.

    Args:
        seed: Decides everything that the arguments leave open.
        library: Any; what it lacks is left out, and `Room.notes` says so.
        kind: Of `RECIPES`; None: drawn from those that the library can furnish.
        ceiling: Whether the room has one; without, nothing hangs from it.

    Raises:
        LibraryError: The library lacks what such a room cannot be without.
        SettingError: There is no such kind.
        SceneError: No arrangement was found.
    """
    kind = _chosen_kind(seed, library, kind)
    return _made(seed, library, kind, RECIPES[kind], ceiling)


def _made(seed: int, library: CadLibrary, kind: RoomKind, recipe: Recipe, ceiling: bool) -> Room:
    """The first attempt at a recipe that is complete."""
    for attempt in range(_ATTEMPTS):
        rng = np.random.default_rng([seed, attempt])
        stock = Stock(library, rng)
        spans = (recipe.width_m, recipe.depth_m, recipe.height_m)
        shell = make_shell(np.array([rng.uniform(*s) for s in spans]), stock, rng, ceiling=ceiling)
        space = _furnished(shell, recipe, stock, rng, ceiling)
        if space is None or len(space.placed) < MIN_ITEMS:
            continue
        stacked = max(len(space.carriers(i)) for i in range(len(space.placed))) >= _DEEPEST
        if stacked or not _stackable(recipe, stock) or attempt >= _STACK_ATTEMPTS:
            if not stacked:
                space.notes.append(f"nothing stands {_DEEPEST} supports deep")
            return _room_in_world(seed, kind, shell, space, rng)
    raise SceneError(
        f"seed {seed}: no arrangement of {library.source} for a room of kind {kind} in "
        f"{_ATTEMPTS} attempts",
        "use another seed or kind, or a library with smaller furniture",
    )


def builtin_room(library: CadLibrary) -> Room:
    """The room of the demonstration: always the same for the same library.

    A kitchen to live in, the first from `BUILTIN_SEED` on that shows every rule (of those that
    the library holds anything for), so that a library that grows does not spoil it; any room
    that the library can furnish where it cannot furnish that one.

    Raises:
        SceneError: no room of the library shows all of them.
        LibraryError: the library has nothing to furnish a room with.
    """
    stock = Stock(library, np.random.default_rng(0))
    if _missing(stock, _BUILTIN_KIND):
        return make_room(BUILTIN_SEED, library)
    wanted = [ROLES[role].class_names for role in _BUILTIN_ROLES if role in stock]
    leans = "book" in stock and "bookshelf" in stock
    for seed in range(BUILTIN_SEED, BUILTIN_SEED + _ATTEMPTS):
        room = _made(seed, library, _BUILTIN_KIND, DEMONSTRATION, ceiling=True)
        held = {item.model.class_name for item in room.items}
        leaning = any(item.attachment == "leaning" for item in room.items)
        if all(held & set(classes) for classes in wanted) and (leaning or not leans):
            return room
    raise SceneError(
        f"no room of {library.source} shows all of {', '.join(_BUILTIN_ROLES)}",
        "use make_room with a seed",
    )


def _chosen_kind(seed: int, library: CadLibrary, kind: str | None) -> RoomKind:
    """The kind that was asked for, or one that the library can furnish."""
    asked: list[RoomKind] = [name for name in RECIPES if kind in (name, None)]
    if not asked:
        raise SettingError(f"no kind of room {kind!r}", f"use one of {', '.join(RECIPES)}")
    stock = Stock(library, np.random.default_rng(0))
    lacks: dict[RoomKind, list[str]] = {name: _missing(stock, name) for name in asked}
    possible: list[RoomKind] = [name for name, missing in lacks.items() if not missing]
    if not possible:
        wants = "; ".join(f"{name}: {', '.join(roles)}" for name, roles in lacks.items())
        raise LibraryError(
            f"{library.source} has no usable model for what a room cannot be without ({wants})",
            "add models of these, or of plausible size; synthetic/roles.py states the bounds",
        )
    return possible[int(np.random.default_rng([seed, len(possible)]).integers(len(possible)))]


def _missing(stock: Stock, kind: RoomKind) -> list[str]:
    """What a kind of room cannot be without and the stock does not hold."""
    needs = RECIPES[kind].needs
    return [" or ".join(roles) for roles in needs if not any(role in stock for role in roles)]


def _furnished(
    shell: Shell, recipe: Recipe, stock: Stock, rng: np.random.Generator, ceiling: bool
) -> Occupancy | None:
    """All steps of a recipe; None where one that must be taken found no place."""
    space = Occupancy(shell.size, shell.zones)
    space.notes += shell.notes
    for opening in shell.items:
        space.add(dataclasses.replace(opening, attachment="wall", role=opening.model.class_name))
    space.notes += _lacking(recipe, stock)
    for step in recipe.steps:
        if isinstance(step, FromCeiling) and not ceiling:
            continue
        if not _take(step, space, stock, rng):
            return None
    return space


def _lacking(recipe: Recipe, stock: Stock) -> list[str]:
    """A line for each role of a recipe that no model of the stock can play."""
    roles = dict.fromkeys(role for step in recipe.steps for role in roles_of(step))
    absent = [role for role in roles if role not in stock]
    return [f"the library has nothing for: {', '.join(absent)}"] if absent else []


def _take(step: Step, space: Occupancy, stock: Stock, rng: np.random.Generator) -> bool:
    """One step; False where it must be taken and could not."""
    match step:
        case Run():
            done = place_run(space, stock, rng, step)
            hang_above_run(space, stock, rng, step)
            return done or not step.must
        case Seating():
            return place_seating(space, stock, rng, step) or not step.must
        case Workplace():
            return place_workplaces(space, stock, rng, step) or not step.must
        case Sleeping():
            return place_sleeping(space, stock, rng, step) or not step.must
        case Lounge():
            return place_lounge(space, stock, rng, step) or not step.must
        case AtWall():
            place_at_walls(space, stock, rng, step)
        case OnWall():
            hang_on_walls(space, stock, rng, step)
        case FromCeiling():
            hang_from_ceiling(space, stock, rng, step)
        case OnFloor():
            place_on_floor(space, stock, rng, step)
        case OnTop():
            place_on_tops(space, stock, rng, step)
        case Stack():
            place_stacks(space, stock, rng, step)
        case LeanOnWall():
            lean_on_walls(space, stock, rng, step)
        case LeanOnTop():
            lean_on_tops(space, stock, rng, step)
    return True


def _stackable(recipe: Recipe, stock: Stock) -> bool:
    """Whether the stock holds something for every level of a stack of the recipe."""
    stacks = [step for step in recipe.steps if isinstance(step, Stack)]
    return any(
        all(any(role in stock for role in roles) for roles in (step.hosts, *step.levels))
        for step in stacks
    )


def _room_in_world(
    seed: int, kind: RoomKind, shell: Shell, space: Occupancy, rng: np.random.Generator
) -> Room:
    """Turn the room off the axes, name everything, and choose the dataset's frame."""
    yaw = float(rng.uniform(0.17, 0.61)) + np.pi / 2 * int(rng.integers(4))
    T_world_room = np.eye(4)
    T_world_room[:2, :2] = rotation_2d(yaw)
    T_world_room[:2, 3] = rng.uniform(-1.0, 1.0, 2)
    tilt, turn = rng.uniform(0.7, 2.4), rng.uniform(-np.pi, np.pi)
    sideways = np.sin(tilt) * np.array([np.cos(turn), np.sin(turn)])
    gravity = np.array([*sideways, -np.cos(tilt)])
    return Room(
        name=f"room_{seed}",
        kind=kind,
        seed=seed,
        layout=tuple(_moved(patch, T_world_room) for patch in shell.layout),
        items=_items(space, T_world_room, shell.layout, rng),
        T_world_room=T_world_room.astype(np.float32),
        size=shell.size,
        T_world_dataset=upright_from_gravity(gravity, float(rng.uniform(0.5, 1.5))),
        gravity_dataset=gravity,
        notes=tuple(dict.fromkeys(space.notes)),
    )


def _moved(patch: LayoutPatch, T: np.ndarray) -> LayoutPatch:
    corners = patch.corners @ T[:3, :3].T + T[:3, 3]
    return dataclasses.replace(patch, corners=corners.astype(np.float32))


def _items(
    space: Occupancy,
    T_world_room: np.ndarray,
    layout: tuple[LayoutPatch, ...],
    rng: np.random.Generator,
) -> tuple[PlacedModel, ...]:
    first = max(patch.id for patch in layout) + 1
    names = [f"{p.model.class_name}_{first + i}" for i, p in enumerate(space.placed)]
    floor = next(patch.name for patch in layout if patch.class_name == "floor")

    def item(i: int, p: Proposal) -> PlacedModel:
        alone = p.parent == ON_NOTHING or p.attachment == "leaning"
        parent = None if alone else floor if p.parent == ON_FLOOR else names[p.parent]
        T = np.eye(4)
        T[:3, :3] = T_world_room[:3, :3] @ p.R_room
        T[:3, 3] = T_world_room[:3, :3] @ p.center + T_world_room[:3, 3]
        return PlacedModel(
            id=first + i,
            model=p.model,
            scale=p.scale,
            T_world_cad=T.astype(np.float32),
            parent=parent,
            parent_plane=None if parent is None else p.plane,
            attachment=p.attachment,
            tint=(rng.uniform(0.75, 1.2) * rng.uniform(0.88, 1.12, 3)).astype(np.float32),
        )

    return tuple(item(i, p) for i, p in enumerate(space.placed))
