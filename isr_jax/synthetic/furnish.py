"""A furnished room from a seed and the models of a library."""

from __future__ import annotations

import numpy as np

from ..cad_types import CadLibrary, CadModel
from ..classes import class_named
from ..errors import LibraryError, SceneError
from .floor_rules import chair_at, hang_on_wall, kitchen_run, stand_at_wall, table_with_chairs
from .placement import ON_FLOOR, ON_NOTHING, Occupancy, Proposal, Stock, rotation_2d
from .room import LayoutPatch, PlacedModel, Room, upright_from_gravity, upright_pose
from .support_rules import put_on

REQUIRED_CLASSES = ("table", "chair", "cabinet", "cup")
MIN_ITEMS = 8
"""Fewest things in a room, layout aside."""
BUILTIN_SEED = 8
_ATTEMPTS = 40
_FLOOR_ID = 1
_ALONG_WALLS = ("desk", "bookshelf", "sofa")
_KITCHEN = ("fridge", "cabinet", "counter", "dishwasher", "oven")
_ON_TOP: tuple[tuple[tuple[str, ...], str, int], ...] = (
    (("desk",), "monitor", 1),
    (("desk",), "book", 1),
    (("bookshelf",), "book", 3),
    (("table",), "cup", 1),
    (("desk", "table"), "laptop", 1),
    (("cabinet", "counter"), "cup", 2),
    (("table", "cabinet", "counter"), "bowl", 1),
    (("table", "cabinet", "counter"), "bottle", 1),
)
"""(carriers, class, how many), in this order."""
_OTHER_ROOMS = {"toilet", "bathtub"}
"""Not seen where people cook, eat and work."""
_SURFACES = ("table", "desk", "cabinet", "counter")


def make_room(seed: int, library: CadLibrary, *, ceiling: bool = False) -> Room:
    """A room furnished with models of ``library``: the same seed, the same room.

    Kitchen furniture along one wall, a table with at least two chairs, what else the library
    holds along the walls, and things on things, three supports deep where the library has
    something flat to stack (book or microwave) below its cups. Boxes keep 2 cm from each other.

    Raises:
        LibraryError: The library lacks one of `REQUIRED_CLASSES`.
        SceneError: No arrangement was found.
    """
    held = {model.class_name for model in library.models}
    missing = [name for name in REQUIRED_CLASSES if name not in held]
    if missing:
        raise LibraryError(
            f"{library.source} has no model of class {', '.join(missing)}",
            f"a room needs at least {', '.join(REQUIRED_CLASSES)}",
        )
    for attempt in range(_ATTEMPTS):
        rng = np.random.default_rng([seed, attempt])
        size = np.array([rng.uniform(4.4, 5.4), rng.uniform(4.2, 5.0), 2.5])
        space = Occupancy(size)
        if _furnish(space, Stock(library, rng), rng) and _complete(space, held):
            return _room_in_world(seed, space, size, rng, ceiling)
    raise SceneError(
        f"seed {seed}: no arrangement of {library.source} in {_ATTEMPTS} attempts",
        "use another seed, or a library with smaller furniture",
    )


def builtin_room(library: CadLibrary) -> Room:
    """The room of the demonstration: always the same for the same library.

    The first from `BUILTIN_SEED` on that shows a class for every rule (of those that the library
    holds), so that a library that grows does not spoil it.
    """
    shown = {*_ALONG_WALLS, "fridge", "microwave", "monitor"}
    wanted = shown & {model.class_name for model in library.models}
    rooms = (make_room(seed, library) for seed in range(BUILTIN_SEED, BUILTIN_SEED + _ATTEMPTS))
    for room in rooms:
        if wanted <= {item.model.class_name for item in room.items}:
            return room
    raise SceneError(
        f"no room of {library.source} has space for all of {', '.join(sorted(wanted))}",
        "use make_room with a seed",
    )


def _furnish(space: Occupancy, stock: Stock, rng: np.random.Generator) -> bool:
    """All rules, in the order in which they need space; False without a table and chairs."""
    kitchen_run(space, stock, rng)
    if table_with_chairs(space, stock, rng, int(rng.integers(2, 5))) is None:
        return False
    for class_name in (name for name in _ALONG_WALLS if name in stock):
        position = stand_at_wall(space, stock, rng, class_name)
        if position is not None and class_name == "desk":
            chair_at(space, stock, rng, position, 0)
    named = {"table", "chair", *_ALONG_WALLS, *_KITCHEN, *_OTHER_ROOMS}
    for class_name in _others(stock, "floor", named):
        stand_at_wall(space, stock, rng, class_name)
    for class_name in _others(stock, "wall", set()):
        for _ in range(2):
            hang_on_wall(space, stock, rng, class_name)
    put_on(space, stock, rng, space.positions("cabinet", "counter"), "microwave")
    _stacks(space, stock, rng)
    _put_things_on_things(space, stock, rng)
    return True


def _put_things_on_things(space: Occupancy, stock: Stock, rng: np.random.Generator) -> None:
    for hosts, class_name, count in _ON_TOP:
        for _ in range(count):
            put_on(space, stock, rng, space.positions(*hosts), class_name)
    named = {"microwave", *(class_name for _, class_name, _ in _ON_TOP)}
    for class_name in _others(stock, "surface", named):
        put_on(space, stock, rng, space.positions(*_SURFACES), class_name)


def _stacks(space: Occupancy, stock: Stock, rng: np.random.Generator) -> None:
    """Thick books on the table with cups on them; on a microwave where there are no books."""
    for _ in range(2):
        book = put_on(space, stock, rng, space.positions("table"), "book", _thick)
        if book is not None:
            put_on(space, stock, rng, [book], "cup")
    if "book" not in stock:
        put_on(space, stock, rng, space.positions("microwave"), "cup")


def _thick(model: CadModel) -> bool:
    """As thick as a voxel, so that a map can tell it from the table."""
    return bool(model.size[2] >= 0.02)


def _others(stock: Stock, mount: str, named: set[str]) -> list[str]:
    """Functional classes of the stock with this mount that no rule names."""
    infos = [class_named(name) for name in stock.class_names if name not in named]
    return [info.name for info in infos if info.mount == mount and info.kind == "thing"]


def _complete(space: Occupancy, held: set[str]) -> bool:
    depth = max(len(space.carriers(i)) for i in range(len(space.placed)))
    stackable = bool(held & {"book", "microwave"})
    articulated = any(p.model.articulated for p in space.placed)
    wanted = any(class_named(name).articulated for name in held & {"cabinet", "fridge"})
    return (
        len(space.placed) >= MIN_ITEMS
        and depth >= (3 if stackable else 2)
        and bool(space.positions("cabinet"))
        and (articulated or not wanted)
    )


def _room_in_world(
    seed: int, space: Occupancy, size: np.ndarray, rng: np.random.Generator, ceiling: bool
) -> Room:
    """Turn the room off the axes, name everything, and choose the dataset's frame."""
    yaw = float(rng.uniform(0.17, 0.61)) + np.pi / 2 * int(rng.integers(4))
    T_world_room = np.eye(4)
    T_world_room[:2, :2] = rotation_2d(yaw)
    T_world_room[:2, 3] = rng.uniform(-1.0, 1.0, 2)
    layout = _layout(size, T_world_room, ceiling)
    tilt, turn = rng.uniform(0.7, 2.4), rng.uniform(-np.pi, np.pi)
    sideways = np.sin(tilt) * np.array([np.cos(turn), np.sin(turn)])
    gravity = np.array([*sideways, -np.cos(tilt)])
    return Room(
        name=f"room_{seed}",
        kind="kitchen",
        seed=seed,
        layout=layout,
        items=_items(space, T_world_room, yaw, len(layout) + 1, rng),
        T_world_room=T_world_room.astype(np.float32),
        size=size.astype(np.float32),
        T_world_dataset=upright_from_gravity(gravity, float(rng.uniform(0.5, 1.5))),
        gravity_dataset=gravity,
    )


def _layout(size: np.ndarray, T_world_room: np.ndarray, ceiling: bool) -> tuple[LayoutPatch, ...]:
    x, y, z = size[0] / 2, size[1] / 2, size[2]
    ground = [(-x, -y, 0), (x, -y, 0), (x, y, 0), (-x, y, 0)]
    patches = [("floor", ground)]
    for i in range(4):
        # Seen from inside the room, the wall's base runs from the later corner to the earlier.
        (bx, by, _), (ax, ay, _) = ground[i], ground[(i + 1) % 4]
        patches.append(("wall", [(ax, ay, 0), (bx, by, 0), (bx, by, z), (ax, ay, z)]))
    if ceiling:
        patches.append(("ceiling", [(px, py, z) for px, py, _ in reversed(ground)]))
    moved = [np.array(p) @ T_world_room[:3, :3].T + T_world_room[:3, 3] for _, p in patches]
    return tuple(
        LayoutPatch(_FLOOR_ID + i, name, corners.astype(np.float32))
        for i, ((name, _), corners) in enumerate(zip(patches, moved, strict=True))
    )


def _items(
    space: Occupancy,
    T_world_room: np.ndarray,
    yaw: float,
    first_id: int,
    rng: np.random.Generator,
) -> tuple[PlacedModel, ...]:
    names = [f"{p.model.class_name}_{first_id + i}" for i, p in enumerate(space.placed)]
    special = {ON_FLOOR: f"floor_{_FLOOR_ID}", ON_NOTHING: None}

    def item(i: int, p: Proposal) -> PlacedModel:
        parent = special[p.parent] if p.parent < 0 else names[p.parent]
        tint = rng.uniform(0.75, 1.2) * rng.uniform(0.88, 1.12, 3)
        return PlacedModel(
            id=first_id + i,
            model=p.model,
            scale=p.scale,
            T_world_cad=upright_pose(
                p.yaw + yaw, T_world_room[:3, :3] @ p.center + T_world_room[:3, 3]
            ),
            parent=parent,
            parent_plane=None if parent is None else p.plane,
            attachment="wall" if p.parent == ON_NOTHING else "none",
            tint=tint.astype(np.float32),
        )

    return tuple(item(i, p) for i, p in enumerate(space.placed))
