"""Doors in their frames.

Interior leaves are 0.61 to 0.985 m wide, 1.985 or 2.11 m high and 39.5 mm thick (DIN 18101) and
weigh 15 to 30 kg; American ones are 24 to 36 in wide, 80 in high and 1 3/8 in thick; entrance
doors are 1 m wide and 55 to 70 mm thick. Handles are 1.05 m above the floor (DIN 18101), frames
are as deep as the wall or half so.
"""

from __future__ import annotations

from typing import Literal

from ....errors import SettingError
from .. import materials as m
from ..builder import ModelBuilder
from ..furniture.fronts import Space, add_bar_handle
from ..solids import between, box, circle, prism
from .leaves import GAP_M, Leaf, add_leaf, add_lever, hinge_leaf

_STOP_M = 0.012
"""The frame's rear part covers so much of the leaf's rim."""
_FLOOR_M = 0.006
"""Between leaf and floor."""
_HANDLE_M = 1.05
_BACKSET_M = 0.06
"""From the leaf's free edge to its spindle."""
FLUSH = Leaf()


def door(
    width: float,
    depth: float,
    height: float,
    *,
    hinge: Literal["left", "right"] = "left",
    leaf: Leaf = FLUSH,
    thickness: float = 0.04,
    jamb: float = 0.045,
    frame: m.Material = m.WHITE_FRAME,
    handle: Literal["lever", "knob", "bar"] = "lever",
    metal: m.Material = m.STEEL,
) -> ModelBuilder:
    """One leaf in a frame ``depth`` deep; it opens to the front, its hinge at ``hinge``.

    Raises:
        SettingError: The frame is too shallow for the leaf.
    """
    builder = ModelBuilder("door", symmetry=1)
    x, y = width / 2, depth / 2
    _add_frame(builder, (x, y, height), jamb, thickness, frame)
    space = (
        (-x + jamb + GAP_M, x - jamb - GAP_M),
        (-y, -y + thickness),
        (_FLOOR_M, height - jamb - GAP_M),
    )
    free = "right" if hinge == "left" else "left"
    add_leaf(builder, "leaf", space, leaf, free)
    _add_handle(builder, "leaf", space, free, handle, metal, height)
    return builder


def _add_frame(builder: ModelBuilder, half: tuple[float, float, float], jamb, thickness, frame):
    """Jambs and head, stepped behind the leaf so that it closes against them."""
    x, y, height = half
    stop = -y + thickness + GAP_M
    if stop + 0.008 > y:
        problem = f"a frame {2 * y:.3g} m deep around a leaf of {thickness:.3g} m"
        raise SettingError(problem, f"ask for at least {thickness + GAP_M + 0.008:.3g} m of depth")
    for side in (-1, 1):
        front = between(side * x, side * (x - jamb))
        rear = between(side * x, side * (x - jamb - _STOP_M))
        builder.add(frame, box(front, (-y, stop), (0.0, height)), carries=False)
        builder.add(frame, box(rear, (stop, y), (0.0, height)), carries=False)
    head = (-x + jamb, x - jamb)
    builder.add(frame, box(head, (-y, stop), (height - jamb, height)), carries=False)
    head = (head[0] + _STOP_M, head[1] - _STOP_M)
    builder.add(frame, box(head, (stop, y), (height - jamb - _STOP_M, height)), carries=False)


def _add_handle(builder: ModelBuilder, link, space: Space, free, kind, metal, height) -> None:
    """A lever on both sides, or a knob or bar on both, and the leaf's hinge."""
    (x0, x1), (y0, y1), _ = space
    right = free == "right"
    x = x1 - _BACKSET_M if right else x0 + _BACKSET_M
    z = min(_HANDLE_M, 0.5 * height)
    if kind == "lever":
        add_lever(builder, link, (x, z), (y0, y1), -1 if right else 1, material=metal)
    elif kind == "knob":
        for face, out in ((y0, -1), (y1, 1)):
            shank = between(face, face + out * 0.03)
            builder.add(
                metal,
                box((x - 0.012, x + 0.012), shank, (z - 0.012, z + 0.012)),
                link=link,
                handle=True,
            )
            ball = between(face + out * 0.03, face + out * 0.06)
            builder.add(metal, prism(circle(0.026, 12, (z, x)), "y", ball), link=link, handle=True)
    else:
        add_bar_handle(
            builder,
            (x, y0, z),
            min(0.6, 0.3 * height),
            upright=True,
            link=link,
            material=metal,
            thickness=0.022,
            reach=0.06,
        )
    hinge_leaf(builder, link, space, free, (x, y0, z))


def double_door(
    width: float,
    depth: float,
    height: float,
    *,
    leaf: Leaf = FLUSH,
    thickness: float = 0.04,
    jamb: float = 0.05,
    frame: m.Material = m.WHITE_FRAME,
    handle: Literal["lever", "knob", "bar"] = "lever",
    metal: m.Material = m.STEEL,
) -> ModelBuilder:
    """Two leaves that meet in the middle and open to the front.

    Raises:
        SettingError: The frame is too shallow for the leaves.
    """
    builder = ModelBuilder("door", symmetry=1)
    x, y = width / 2, depth / 2
    _add_frame(builder, (x, y, height), jamb, thickness, frame)
    tall = (_FLOOR_M, height - jamb - GAP_M)
    for k, side in enumerate((-1, 1)):
        across = between(side * GAP_M / 2, side * (x - jamb - GAP_M))
        space = (across, (-y, -y + thickness), tall)
        free = "right" if side < 0 else "left"
        link = f"leaf_{k + 1}"
        add_leaf(builder, link, space, leaf, free)
        _add_handle(builder, link, space, free, handle, metal, height)
    return builder


def barn_door(
    width: float,
    depth: float,
    height: float,
    *,
    leaf: Leaf = FLUSH,
    rail: float = 0.04,
    metal: m.Material = m.BLACK_METAL,
) -> ModelBuilder:
    """A leaf that hangs on a rail before a wall, at the left, and slides to the right.

    The rail is twice as long as the leaf is wide; rail and leaf are what the box holds.
    """
    builder = ModelBuilder("door", symmetry=1, mount="wall")
    x, y, lift = width / 2, depth / 2, 0.01
    track = (height - 0.07, height - 0.07 + rail)
    back, hang = y - 0.018, 0.008
    builder.add(metal, box((-x, x), (back - hang, back), track), carries=False)
    for k in range(5):
        c = round(-x + 0.05 + k * (width - 0.1) / 4, 4)
        builder.add(metal, box((c - 0.015, c + 0.015), (back, y), track), carries=False)
    thick = back - hang - GAP_M - 0.01 + y
    space = ((-x, -GAP_M), (-y, -y + thick), (lift, track[0] - 0.02))
    add_leaf(builder, "leaf", space, leaf, None)
    guide = -GAP_M - 0.4 * x
    builder.add(
        metal, box((guide - 0.02, guide + 0.02), (-y, y), (0.0, lift - GAP_M)), carries=False
    )
    for share in (0.15, 0.85):
        c = round(-x + share * (x - GAP_M), 4)
        strap = (c - 0.02, c + 0.02)
        builder.add(metal, box(strap, (-y, -y + 0.006), (space[2][1], height)), link="leaf")
        wheel = (-y + 0.006, back - hang)
        tread = box(strap, wheel, (track[1] + GAP_M, height))
        builder.add(metal, tread, link="leaf")
    at = (-GAP_M - 0.07, -y, min(_HANDLE_M, 0.5 * height))
    add_bar_handle(builder, at, 0.3, upright=True, link="leaf", material=metal, thickness=0.02)
    builder.slide("leaf", (1, 0, 0), round(x - 0.01, 3), damping=15.0, friction=6.0)
    return builder
