"""The five kinds of room, as recipes."""

from __future__ import annotations

from ..room import RoomKind
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
    Roles,
    Run,
    Seating,
    Sleeping,
    Stack,
    Step,
    Workplace,
)

_WORKTOPS = ("worktop", "base cabinet")
_SHELVES = ("bookshelf", "wall shelf")
_FLAT = ("thick book", "closed box", "carton", "microwave", "small oven")
_BOARDS = ("sideboard", "chest", "tv bench", "pedestal")
_TABLES = ("dining table", "meeting table", "low table", "side table")
_SMALL = ("cup", "bowl", "book", "small box", "vase", "small plant", "bottle", "clock", "remote")
_LEANS = ("picture", "mirror", "wall screen", "bag")


def _desk_things(hosts: Roles) -> tuple[Step, ...]:
    """What lies on every desk, and the clutter of all."""
    return (
        OnTop(hosts, ("monitor",), (1, 1), (0.0, 0.75), each=True),
        OnTop(hosts, ("keyboard",), (1, 1), (0.0, -0.25), each=True),
        OnTop(hosts, ("mouse",), (1, 1), (0.4, -0.25), each=True),
        OnTop(hosts, ("laptop",), (0, 1), (-0.6, -0.1), each=True),
        OnTop(hosts, ("desk lamp", "table lamp"), (0, 1), (0.8, 0.7), each=True),
        Stack(hosts, (_FLAT, ("cup", "phone", "small box")), (1, 2)),
        OnTop(hosts, ("cup", "bottle", "book", "phone"), (1, 3), each=True),
        OnTop(hosts, ("small plant", "clock", "small box", "vase"), (0, 2)),
    )


def _shelf_things(count: tuple[int, int]) -> tuple[Step, ...]:
    """Books that lean, books that lie, and things on books."""
    return (
        LeanOnTop(_SHELVES, ("book",), (1, 3)),
        Stack(_SHELVES, (_FLAT, ("cup", "clock", "small box", "phone")), (1, 2)),
        OnTop(_SHELVES, ("book", "small box", "vase", "small plant", "bowl"), count),
    )


KITCHEN = Recipe(
    width_m=(4.4, 5.3),
    depth_m=(4.1, 4.8),
    height_m=(2.4, 2.7),
    needs=(_WORKTOPS, ("dining table",), ("dining chair",)),
    steps=(
        Run(
            (
                ("fridge",),
                _WORKTOPS,
                ("kitchen sink", "base cabinet"),
                ("base cabinet",),
                ("dishwasher", "washing machine"),
                ("cooker",),
                _WORKTOPS,
            ),
            above=("wall cabinet",),
        ),
        Seating(("dining table",), ("dining chair",), (3, 5)),
        AtWall(("sofa",), (0, 1), 0.4),
        Workplace(("desk",), ("office chair", "dining chair"), (0, 1), must=False),
        AtWall(("bookshelf",), (0, 1), 0.4),
        AtWall(("sideboard", "tall cabinet"), (0, 1), 0.4),
        AtWall(("bin",)),
        AtWall(("floor plant",), (0, 1)),
        LeanOnWall(_LEANS, (1, 1)),
        AtWall(("bag",), (0, 1)),
        OnWall(("wall shelf",), (0, 1), (1.05, 1.2)),
        OnWall(("picture",), (1, 2)),
        OnWall(("curtain",), (1, 2), (0.05, 0.3), near=("window",)),
        OnWall(("wall lamp",), (0, 1), (1.5, 1.7)),
        FromCeiling(("ceiling lamp",), ("dining table",)),
        OnFloor(("rug",)),
        OnTop(_WORKTOPS, ("microwave", "small oven"), (1, 1), (None, 0.6)),
        OnTop(_WORKTOPS, ("kettle",), (1, 1), (None, 0.4)),
        OnTop(_WORKTOPS, ("basin",), (0, 1)),
        Stack(("dining table",), (_FLAT, ("cup", "bowl")), (2, 2)),
        Stack(_WORKTOPS, (("microwave", "small oven", "closed box"), ("bowl", "cup")), (1, 1)),
        LeanOnTop(_WORKTOPS + _BOARDS, ("book",), (1, 2)),
        *_desk_things(("desk",)),
        *_shelf_things((2, 5)),
        OnTop(("dining table",), ("cup", "bowl"), (2, 4)),
        OnTop(("dining table",), ("bottle", "vase", "small plant"), (1, 2)),
        OnTop(_WORKTOPS, ("bowl", "bottle", "cup"), (4, 7)),
        OnTop(_WORKTOPS + _BOARDS, ("small plant", "small box", "vase", "clock"), (1, 3)),
    ),
)

OFFICE = Recipe(
    width_m=(4.3, 5.3),
    depth_m=(4.0, 4.8),
    height_m=(2.5, 2.8),
    needs=(("desk",), ("office chair", "dining chair")),
    steps=(
        Workplace(("desk",), ("office chair", "dining chair"), (2, 3)),
        Seating(("side table", "low table"), ("stool", "dining chair"), (1, 2), must=False),
        AtWall(("bookshelf",), (1, 2), 0.4),
        AtWall(("tall cabinet", "sideboard"), (1, 1), 0.4),
        AtWall(("pedestal",), (1, 2), 0.2),
        AtWall(("floor plant",), (0, 1)),
        AtWall(("bin",), (1, 2)),
        AtWall(("floor lamp",), (0, 1)),
        LeanOnWall(_LEANS, (1, 2)),
        AtWall(("floor box",), (0, 2)),
        AtWall(("bag",), (1, 1)),
        OnWall(("wall screen",), (0, 1), (1.1, 1.3)),
        OnWall(("wall shelf",), (0, 1), (1.05, 1.2)),
        OnWall(("picture",), (1, 2)),
        OnWall(("curtain",), (1, 2), (0.05, 0.3), near=("window",)),
        FromCeiling(("ceiling lamp",)),
        OnFloor(("rug",), (0, 1)),
        *_desk_things(("desk",)),
        *_shelf_things((5, 10)),
        LeanOnTop(_BOARDS, ("book",), (0, 1)),
        OnTop(_BOARDS + _TABLES, _SMALL, (4, 8)),
    ),
)

LIVING = Recipe(
    width_m=(4.6, 5.6),
    depth_m=(4.2, 5.0),
    height_m=(2.4, 2.8),
    needs=(("sofa",),),
    steps=(
        Lounge(("sofa",), ("low table",), ("armchair", "stool"), ("tv bench", "sideboard")),
        Seating(("dining table",), ("dining chair",), (2, 4), must=False),
        AtWall(("bookshelf",), (1, 2), 0.4),
        AtWall(("sideboard", "chest"), (0, 1), 0.4),
        AtWall(("side table",), (1, 1)),
        AtWall(("floor lamp",), (1, 1)),
        AtWall(("floor plant",), (1, 2)),
        LeanOnWall(_LEANS, (1, 2)),
        AtWall(("stool",), (0, 1)),
        AtWall(("bag",), (0, 1)),
        AtWall(("floor box",), (0, 1)),
        OnWall(("wall shelf",), (0, 1), (1.05, 1.2)),
        OnWall(("picture", "mirror"), (1, 3)),
        OnWall(("curtain",), (1, 2), (0.05, 0.3), near=("window",)),
        OnWall(("wall lamp",), (0, 2), (1.5, 1.7)),
        FromCeiling(("ceiling lamp",), ("dining table", "low table")),
        OnFloor(("rug",), (1, 2)),
        OnTop(("tv bench", "sideboard"), ("television", "monitor"), (1, 1), (0.0, 0.5)),
        Stack(
            ("low table", "dining table", "sideboard"), (_FLAT, ("cup", "bowl", "remote")), (1, 2)
        ),
        Stack(("side table", *_BOARDS), (_FLAT, ("cup", "small box", "clock")), (0, 1)),
        LeanOnTop(_BOARDS, ("book",), (1, 1)),
        *_shelf_things((5, 10)),
        OnTop(("sofa",), ("cushion",), (1, 3)),
        OnTop(("side table", *_BOARDS), ("table lamp",), (1, 2)),
        OnTop(("low table",), ("remote", "cup", "bowl", "book", "bottle"), (3, 5)),
        OnTop(("dining table",), ("cup", "bowl", "bottle", "vase"), (3, 5)),
        OnTop((*_BOARDS, "side table"), _SMALL, (5, 9)),
    ),
)

BEDROOM = Recipe(
    width_m=(3.9, 5.0),
    depth_m=(3.8, 4.8),
    height_m=(2.4, 2.7),
    needs=(("bed",),),
    steps=(
        Sleeping(("bed",), ("nightstand",)),
        AtWall(("wardrobe", "tall cabinet"), (1, 1), 0.5),
        AtWall(("chest", "sideboard"), (1, 1), 0.4),
        Workplace(("desk",), ("dining chair", "office chair"), (0, 1), must=False),
        AtWall(("bookshelf",), (0, 1), 0.4),
        AtWall(("armchair", "dining chair"), (0, 1), 0.4),
        AtWall(("stool",), (0, 1)),
        AtWall(("floor lamp", "floor plant"), (0, 1)),
        LeanOnWall(_LEANS, (1, 1)),
        AtWall(("bag",), (1, 2)),
        AtWall(("floor box",), (1, 2)),
        AtWall(("bin",), (0, 1)),
        OnWall(("wall shelf",), (0, 1), (1.05, 1.2)),
        OnWall(("picture", "mirror"), (1, 2)),
        OnWall(("curtain",), (1, 2), (0.05, 0.3), near=("window",)),
        OnWall(("wall lamp",), (0, 2), (1.2, 1.5)),
        FromCeiling(("ceiling lamp",), ("bed",)),
        OnFloor(("rug",), (1, 2)),
        OnTop(("nightstand",), ("table lamp",), (1, 1), (None, 0.6), each=True),
        Stack(
            ("nightstand", "chest", "sideboard", "desk", "wardrobe"),
            (_FLAT, ("cup", "clock", "phone", "bowl")),
            (2, 3),
        ),
        OnTop(("nightstand",), ("cup", "phone", "clock", "book", "bottle"), (1, 2), each=True),
        LeanOnTop(_BOARDS, ("book",), (1, 1)),
        *_desk_things(("desk",)),
        *_shelf_things((4, 8)),
        OnTop(("bed",), ("book", "laptop", "closed box", "cushion"), (1, 3)),
        OnTop(_BOARDS, ("television",), (0, 1), (0.0, 0.4)),
        OnTop(_BOARDS, _SMALL, (5, 9)),
    ),
)

MEETING = Recipe(
    width_m=(4.8, 5.8),
    depth_m=(3.9, 4.8),
    height_m=(2.5, 2.8),
    needs=(("meeting table", "dining table"), ("office chair", "dining chair")),
    steps=(
        Seating(
            ("meeting table", "dining table"),
            ("office chair", "dining chair"),
            (4, 8),
            turn_rad=0.06,
            long_sides_only=True,
        ),
        AtWall(("sideboard", "tv bench", "tall cabinet"), (1, 1), 0.3),
        AtWall(("bookshelf",), (0, 1), 0.3),
        AtWall(("pedestal", "chest"), (0, 1), 0.2),
        AtWall(("floor plant",), (1, 2)),
        AtWall(("bin",), (1, 1)),
        AtWall(("dining chair", "stool"), (0, 2)),
        LeanOnWall(_LEANS, (1, 1)),
        AtWall(("bag",), (1, 2)),
        AtWall(("floor box",), (0, 1)),
        OnWall(("wall screen", "television"), (1, 1), (1.0, 1.2)),
        OnWall(("picture",), (1, 2)),
        OnWall(("wall shelf",), (0, 1), (1.05, 1.2)),
        OnWall(("curtain",), (1, 2), (0.05, 0.3), near=("window",)),
        FromCeiling(("ceiling lamp",), ("meeting table", "dining table")),
        Stack(("meeting table", "dining table"), (_FLAT, ("cup", "phone", "small box")), (2, 3)),
        OnTop(("meeting table", "dining table"), ("laptop",), (2, 4)),
        OnTop(("meeting table", "dining table"), ("cup", "bottle"), (5, 8)),
        OnTop(("meeting table", "dining table"), ("book", "phone", "bowl"), (2, 5)),
        LeanOnTop(_BOARDS, ("book",), (0, 1)),
        *_shelf_things((4, 7)),
        OnTop(_BOARDS, ("kettle", "vase", "small plant", "cup", "bottle", "table lamp"), (4, 7)),
    ),
)

DEMONSTRATION = Recipe(
    width_m=(4.6, 5.0),
    depth_m=(4.3, 4.7),
    height_m=(2.5, 2.5),
    needs=KITCHEN.needs,
    steps=(
        Run((("fridge",), _WORKTOPS, ("cooker",), _WORKTOPS), above=("wall cabinet",)),
        Seating(("dining table",), ("dining chair",), (3, 4)),
        Workplace(("desk",), ("office chair", "dining chair")),
        AtWall(("bookshelf",), (1, 1), 0.4),
        AtWall(("sofa",), (1, 1), 0.4),
        AtWall(("bin",)),
        LeanOnWall(_LEANS),
        OnWall(("picture",)),
        FromCeiling(("ceiling lamp",), ("dining table",)),
        OnTop(_WORKTOPS, ("microwave",), (1, 1), (None, 0.6)),
        OnTop(_WORKTOPS, ("kettle",)),
        Stack(("dining table",), (_FLAT, ("cup",)), (2, 2)),
        OnTop(("desk",), ("monitor",), (1, 1), (0.0, 0.75)),
        OnTop(("desk",), ("keyboard",), (1, 1), (0.0, -0.25)),
        OnTop(("desk",), ("book", "laptop"), (1, 2)),
        LeanOnTop(_SHELVES, ("book",)),
        OnTop(_SHELVES, ("book", "vase", "small plant"), (2, 3)),
        OnTop(("dining table",), ("cup", "bowl", "bottle"), (2, 3)),
        OnTop(_WORKTOPS, ("bowl", "bottle", "cup"), (2, 4)),
    ),
)
"""A kitchen to live in: every rule once, and less on the tables."""

RECIPES: dict[RoomKind, Recipe] = {
    "kitchen": KITCHEN,
    "office": OFFICE,
    "living": LIVING,
    "bedroom": BEDROOM,
    "meeting": MEETING,
}
"""By kind."""
