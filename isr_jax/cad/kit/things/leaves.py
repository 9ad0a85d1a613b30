"""Leaves of doors and sashes of windows, and the handles on them.

A leaf turns about the outer edge of its front face, so that it never leaves its own width while
it opens to 90 degrees; the edge that swings free is bevelled, so that it passes as narrow a gap
as the others. Real lever handles are held up by a spring: here their short end outweighs the long
one, so that they rest against their stop.
"""

from __future__ import annotations

import dataclasses
import itertools
from typing import Literal

from .. import materials as m
from ..builder import ModelBuilder
from ..furniture.fronts import Bounds, Space
from ..solids import Solid, between, box, prism

GAP_M = 0.003
"""Around a leaf."""
OPEN_RAD = 1.57
Side = Literal["left", "right", "top"]
_LEVER_RAD = 0.7
_LEVER_M, _TAIL_M = 0.115, 0.04
_PROUD_M = 0.008
"""Plates stand out so much from the leaf."""


@dataclasses.dataclass(frozen=True)
class Leaf:
    """What a leaf or sash is made of."""

    material: m.Material = m.WHITE_DOOR
    fill: m.Material | None = None
    """Of panels or panes between stiles and rails; None: one flush slab."""
    stile: float = 0.11
    """Width of the members at the sides and above, metres."""
    sill: float = 0.11
    """Height of the lowest member, metres."""
    fields: tuple[float, ...] = (1.0,)
    """Shares of the height of panels above one another, from below."""
    columns: int = 1
    """Panels beside one another."""
    bar: float = 0.11
    """Width of the members between panels, metres."""
    thickness: float = 0.4
    """Of panels, a share of the leaf's."""


def add_leaf(builder: ModelBuilder, link: str, space: Space, leaf: Leaf, free: Side | None) -> None:
    """Fill ``space`` with a leaf; its edge at ``free`` swings past its frame (None: it slides)."""
    (x0, x1), y, (z0, z1) = space
    if leaf.fill is None:
        builder.add(leaf.material, _member(space, free, y[1] - y[0], space), link=link)
        return
    s, deep = leaf.stile, y[1] - y[0]
    level: list[Bounds] = [(z0, z0 + leaf.sill), (z1 - s, z1)]
    inner = ((x0 + s, x1 - s), (z0 + leaf.sill, z1 - s))
    for x in ((x0, x0 + s), (x1 - s, x1)):
        tall = inner[1] if free == "top" else (z0, z1)
        builder.add(leaf.material, _member((x, y, tall), free, deep, space), link=link)
    across = (x0, x1) if free == "top" else inner[0]
    for z in level:
        builder.add(leaf.material, _member((across, y, z), free, deep, space), link=link)
    _add_fields(builder, link, (*inner, y), leaf, leaf.fill)


def _member(part: Space, free: Side | None, deep: float, whole: Space) -> Solid:
    """One member; bevelled if it lies at the edge that swings free."""
    (x0, x1), (y0, y1), (z0, z1) = part
    edges = {"left": x0 == whole[0][0], "right": x1 == whole[0][1], "top": z1 == whole[2][1]}
    if free is None or not edges[free]:
        return box(*part)
    along = 2 if free == "top" else 0
    radius = whole[along][1] - whole[along][0]
    # The slanted edge stays within the circle that its front corner turns on.
    cut = round(0.55 * deep**2 / radius + 0.0002, 5)
    if free == "top":
        return prism([(y0, z1), (y0, z0), (y1, z0), (y1, z1 - cut)], "x", (x0, x1))
    a, b = (x0 + cut, x1) if free == "left" else (x0, x1 - cut)
    return prism([(x0, y0), (x1, y0), (b, y1), (a, y1)], "z", (z0, z1))


def _add_fields(builder: ModelBuilder, link: str, space, leaf: Leaf, fill: m.Material) -> None:
    """Panels of ``fill`` and the members between them, in bounds along x, z and y."""
    (x0, x1), (z0, z1), y = space
    thin = leaf.thickness * (y[1] - y[0])
    middle = (y[0] + y[1]) / 2
    deep = (middle - thin / 2, middle + thin / 2)
    rows = _cells(z0, z1, leaf.fields, leaf.bar)
    columns = _cells(x0, x1, (1.0,) * leaf.columns, leaf.bar)
    for low, high in itertools.pairwise(rows):
        builder.add(leaf.material, box((x0, x1), y, (low[1], high[0])), link=link)
    for row in rows:
        for left, right in itertools.pairwise(columns):
            builder.add(leaf.material, box((left[1], right[0]), y, row), link=link)
        for column in columns:
            builder.add(fill, box(column, deep, row), link=link)


def _cells(low: float, high: float, shares: tuple[float, ...], bar: float) -> list[Bounds]:
    """Spans of panels between bars, in proportion to their shares."""
    room = high - low - bar * (len(shares) - 1)
    cells, at = [], low
    for k, share in enumerate(shares):
        end = high if k == len(shares) - 1 else round(at + room * share / sum(shares), 4)
        cells.append((at, end))
        at = end + bar
    return cells


def hinge_leaf(builder: ModelBuilder, link: str, space: Space, free: Side, at) -> None:
    """Hinge a leaf opposite its ``free`` edge, so that it opens to the front."""
    (x0, x1), (y0, _), (z0, z1) = space
    x, z = (x0 + x1) / 2, (z0 + z1) / 2
    if free in ("left", "right"):
        edge, axis = (x0 if free == "right" else x1, y0, z), (0, 0, -1 if free == "right" else 1)
        builder.hinge(link, edge, axis, OPEN_RAD, damping=2.0, friction=0.8, at=at)
    else:
        builder.hinge(link, (x, y0, z0), (1, 0, 0), 0.35, damping=4.0, friction=4.0, at=at)


def add_lever(
    builder: ModelBuilder,
    leaf: str,
    at: tuple[float, float],
    faces: tuple[float, ...],
    towards: int,
    *,
    material: m.Material = m.STEEL,
    plate: Bounds = (0.04, 0.2),
) -> None:
    """A lever on a spindle through a leaf.

    Args:
        builder: Takes the plates on the leaf, and a link of their own for the levers.
        leaf: Link that carries it.
        at: Spindle (x, z).
        faces: Front of the leaf, and its rear for a lever on both sides.
        towards: 1 or -1: the lever points along x so, away from the leaf's free edge.
        material: Of plates and levers.
        plate: Width and height of the plates.
    """
    x, z = at
    link = f"lever_{sum(name.startswith('lever') for name in builder.links) + 1}"
    half = plate[0] / 2
    for face, out in zip(faces, (-1, 1)):
        shield = between(face, face + out * _PROUD_M)
        low = z - 0.65 * plate[1]
        builder.add(
            material,
            box((x - half, x + half), shield, (low, low + plate[1])),
            link=leaf,
            handle=True,
        )
        near, far = face + out * (_PROUD_M + 0.0025), face + out * 0.056
        neck = between(near, far - out * 0.014)
        builder.add(
            material, box((x - 0.01, x + 0.01), neck, (z - 0.01, z + 0.01)), link=link, handle=True
        )
        grip = between(far - out * 0.014, far)
        arm = between(x + towards * 0.01, x + towards * _LEVER_M)
        builder.add(m.LEVER, box(arm, grip, (z - 0.009, z + 0.009)), link=link, handle=True)
        tail = between(x + towards * 0.01, x - towards * _TAIL_M)
        builder.add(m.STEEL, box(tail, grip, (z - 0.012, z + 0.012)), link=link, handle=True)
    end = (x + towards * (_LEVER_M - 0.01), faces[0] - 0.049, z)
    builder.knob(
        link,
        (x, faces[0], z),
        (0, towards, 0),
        _LEVER_RAD,
        parent=leaf,
        damping=0.02,
        friction=0.05,
        at=end,
    )


def add_catch(
    builder: ModelBuilder, sash: str, at: tuple[float, float, float], towards: int, material
) -> None:
    """A handle that hangs down before a sash and turns level.

    ``at`` is on the front of the sash; it turns ``towards`` 1 or -1 along x.
    """
    x, face, z = at
    link = f"catch_{sum(name.startswith('catch') for name in builder.links) + 1}"
    shield = box((x - 0.014, x + 0.014), (face - 0.008, face), (z - 0.05, z + 0.03))
    builder.add(material, shield, link=sash, handle=True)
    neck = box((x - 0.008, x + 0.008), (face - 0.036, face - 0.0105), (z - 0.008, z + 0.008))
    builder.add(material, neck, link=link, handle=True)
    arm = box((x - 0.009, x + 0.009), (face - 0.048, face - 0.036), (z - 0.11, z + 0.01))
    builder.add(material, arm, link=link, handle=True)
    end = (x, face - 0.042, z - 0.1)
    builder.knob(
        link, (x, face, z), (0, -towards, 0), 1.57, parent=sash, damping=0.02, friction=0.15, at=end
    )
