"""Windows in their frames.

Casements are 0.4 to 1.2 m wide and 0.6 to 1.5 m high a sash; PVC profiles are 70 to 82 mm deep,
wooden ones 68 to 78 mm; frame and sash are 60 to 75 mm wide each. A sash of 0.8 m2 with double
glazing (20 kg/m2) weighs 20 to 25 kg.
"""

from __future__ import annotations

import dataclasses
from typing import Literal

from ....errors import SettingError
from .. import materials as m
from ..builder import BASE, ModelBuilder
from ..furniture.fronts import Space
from ..solids import box
from .leaves import GAP_M, Leaf, Side, add_catch, add_leaf, hinge_leaf
from .sliders import PROFILE, sliding_door

Sash = Literal["left", "right", "bottom", "fixed"]
_STOP_M = 0.01
SASH = dataclasses.replace(PROFILE, stile=0.06, sill=0.06)
_FREE: dict[str, Side] = {"left": "right", "right": "left", "bottom": "top"}


def casement_window(
    width: float,
    depth: float,
    height: float,
    *,
    sashes: tuple[Sash, ...] = ("left",),
    leaf: Leaf = SASH,
    frame: float = 0.055,
    mullion: float = 0.06,
    metal: m.Material = m.STEEL,
) -> ModelBuilder:
    """Sashes beside one another that open to the front (into the room).

    A sash is named by the side of its hinge; ``bottom`` tilts, ``fixed`` does not move.

    Raises:
        SettingError: The sashes would be too narrow.
    """
    builder = ModelBuilder("window", symmetry=2 if set(sashes) == {"fixed"} else 1)
    x, y, count = width / 2, depth / 2, len(sashes)
    wide = (width - 2 * frame - (count - 1) * mullion) / count
    if wide < 3 * leaf.stile:
        problem = f"{count} sashes in a frame {width:.3g} m wide"
        raise SettingError(problem, "ask for a wider window, or for fewer sashes")
    tall = (frame, height - frame)
    for z in ((0.0, frame), (tall[1], height)):
        builder.add(leaf.material, box((-x, x), (-y, y), z), carries=False)
    for side in ((-x, -x + frame), (x - frame, x)):
        builder.add(leaf.material, box(side, (-y, y), tall), carries=False)
    for k, sash in enumerate(sashes):
        left = round(-x + frame + k * (wide + mullion), 5)
        right = x - frame if k == count - 1 else round(left + wide, 5)
        if k:
            last = round(left - mullion, 5)
            builder.add(leaf.material, box((last, left), (-y, y), tall), carries=False)
        _add_sash(builder, sash, ((left, right), (-y, y), tall), leaf, metal)
    return builder


def _add_sash(builder: ModelBuilder, sash: Sash, opening: Space, leaf: Leaf, metal) -> None:
    (x0, x1), (y0, y1), (z0, z1) = opening
    thick = 0.8 * (y1 - y0)
    if sash == "fixed":
        inset = (y1 - y0 - thick) / 2
        middle = ((x0, x1), (y0 + inset, y1 - inset), (z0, z1))
        add_leaf(builder, BASE, middle, leaf, None)
        return
    _add_stop(builder, opening, y0 + thick + GAP_M, leaf.material)
    link = f"sash_{sum(name.startswith('sash') for name in builder.links) + 1}"
    space = ((x0 + GAP_M, x1 - GAP_M), (y0, y0 + thick), (z0 + GAP_M, z1 - GAP_M))
    free = _FREE[sash]
    add_leaf(builder, link, space, leaf, free)
    x, z, half = (x0 + x1) / 2, (z0 + z1) / 2, leaf.stile / 2
    at = {
        "left": (x0 + GAP_M + half, z),
        "right": (x1 - GAP_M - half, z),
        "top": (x, z1 - GAP_M - half),
    }[free]
    towards = 1 if free == "left" else -1
    add_catch(builder, link, (at[0], y0, at[1]), towards, metal)
    hinge_leaf(builder, link, space, free, (at[0], y0, at[1]))


def _add_stop(builder: ModelBuilder, opening: Space, start: float, material: m.Material) -> None:
    """A rim behind the sash that it closes against."""
    (x0, x1), (_, y1), (z0, z1) = opening
    deep = (start, y1)
    for x in ((x0, x0 + _STOP_M), (x1 - _STOP_M, x1)):
        builder.add(material, box(x, deep, (z0, z1)), carries=False)
    for z in ((z0, z0 + _STOP_M), (z1 - _STOP_M, z1)):
        builder.add(material, box((x0 + _STOP_M, x1 - _STOP_M), deep, z), carries=False)


def sliding_window(
    width: float,
    depth: float,
    height: float,
    *,
    leaf: Leaf = SASH,
    frame: float = 0.045,
) -> ModelBuilder:
    """A pane at the right that slides to the left before a fixed one."""
    return sliding_door(
        width, depth, height, leaf=leaf, jamb=frame, sill=frame, class_name="window"
    )
