"""Taps: a mixer with a lever, a tall spout that swings, pillar taps with knobs.

Mixers of washbasins stand 0.12 to 0.18 m high and reach 0.1 to 0.14 m, kitchen ones 0.25 to 0.4 m
high and reach 0.18 to 0.23 m (EN 817 and makers' catalogues). All reach towards -y.
"""

from __future__ import annotations

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..shapes.shells import arch
from ..solids import ROUND_SIDES, Solid, box, frustum, prism

Point = tuple[float, float, float]
_GAP_M = 0.0025
_LEVER_RAD = 0.5
_SWING_RAD = 1.2


def _column(at: Point, half: float, height: float) -> Solid:
    """An upright bar of eight sides, flat in front."""
    x, y, z = at
    c = 0.3 * half
    corner = half - c
    outline = [
        (-corner, -half),
        (corner, -half),
        (half, -corner),
        (half, corner),
        (corner, half),
        (-corner, half),
        (-half, corner),
        (-half, -corner),
    ]
    return prism([(x + dx, y + dy) for dx, dy in outline], "z", (z, z + height))


def _new(builder: ModelBuilder, kind: str) -> str:
    return f"{kind}_{sum(name.startswith(kind) for name in builder.links) + 1}"


def add_mixer(
    builder: ModelBuilder,
    at: Point,
    height: float,
    *,
    reach: float = 0.12,
    metal: m.Material = m.CHROME,
) -> None:
    """A column with a spout, and on it a lever that lifts; ``at`` is the middle of its foot."""
    x, y, z = at
    half, width = 0.021, 0.014
    builder.add(metal, _column(at, half, height), carries=False)
    tip, low, high = y - reach, z + 0.5 * height, z + 0.8 * height
    profile = [(y - half, low), (y - half, high), (tip, high - 0.008), (tip, high - 0.024)]
    spout = prism(profile, "x", (x - width, x + width))
    builder.add(metal, spout, carries=False)
    name, top = _new(builder, "lever"), z + height + _GAP_M
    plate = box((x - 0.014, x + 0.014), (y - half - 0.05, y + half), (top, top + 0.01))
    builder.add(metal, plate, link=name, handle=True)
    builder.hinge(
        name,
        (x, y + half, top),
        (-1, 0, 0),
        _LEVER_RAD,
        damping=0.02,
        friction=0.15,
        at=(x, y - half - 0.05, top + 0.005),
    )


def add_tall_tap(
    builder: ModelBuilder,
    at: Point,
    height: float,
    *,
    reach: float = 0.2,
    metal: m.Material = m.CHROME,
) -> None:
    """A bent spout that swings to both sides, with a lever at the right of its foot."""
    x, y, z = at
    foot, half, bar = 0.06, 0.023, 0.011
    bend = round(min(reach / 2, height - foot - bar - 0.03), 4)
    builder.add(metal, _column(at, half, foot), carries=False)
    stub = box((x + half, x + half + 0.012), (y - 0.01, y + 0.01), (z + 0.02, z + 0.04))
    builder.add(metal, stub, carries=False)
    name, center = _new(builder, "spout"), z + height - bend - bar
    width = (x - bar, x + bar)
    riser = box(width, (y - bar, y + bar), (z + foot + _GAP_M, center))
    bow = arch((y - bend, center), (bend - bar, bend + bar), (0.0, np.pi), width)
    end = y - 2 * bend
    drop = box(width, (end - bar, end + bar), (center - 0.03, center))
    builder.add(metal, riser, *bow, drop, link=name, carries=False)
    tip = (x, end, center - 0.03)
    builder.hinge(
        name,
        (x, y, z + foot),
        (0, 0, 1),
        _SWING_RAD,
        lower_rad=-_SWING_RAD,
        damping=0.05,
        friction=0.2,
        at=tip,
    )
    _add_side_lever(builder, (x + half + 0.012 + _GAP_M, y, z + 0.03), metal)


def _add_side_lever(builder: ModelBuilder, at: Point, metal: m.Material) -> None:
    """An upright lever that tips to the front, on the end of a stub."""
    x, y, z = at
    name = _new(builder, "lever")
    bar = box((x, x + 0.01), (y - 0.008, y + 0.008), (z - 0.01, z + 0.075))
    builder.add(metal, bar, link=name, handle=True)
    builder.hinge(
        name, at, (1, 0, 0), _LEVER_RAD, damping=0.02, friction=0.15, at=(x + 0.005, y, z + 0.075)
    )


def add_pillar_tap(
    builder: ModelBuilder,
    at: Point,
    height: float,
    *,
    reach: float = 0.09,
    metal: m.Material = m.CHROME,
    sides: int = ROUND_SIDES,
) -> None:
    """A short tap with a knob with four arms on top."""
    x, y, z = at
    half = 0.015
    builder.add(metal, _column(at, half, height), carries=False)
    low = z + 0.45 * height
    spout = box((x - 0.011, x + 0.011), (y - reach, y - half), (low, low + 0.022))
    nose = (y - reach, y - reach + 0.02)
    builder.add(metal, spout, carries=False)
    builder.add(metal, box((x - 0.011, x + 0.011), nose, (low - 0.012, low)), carries=False)
    name, top = _new(builder, "knob"), z + height + _GAP_M
    hub, arm, r = 0.012, 0.03, 0.005
    builder.add(
        metal, frustum((hub, hub), (top, top + 0.012), (x, y), sides), link=name, handle=True
    )
    bars = (top + 0.012, top + 0.022)
    pieces = [box((x - arm, x + arm), (y - r, y + r), bars)]
    pieces += [box((x - r, x + r), (y + a, y + b), bars) for a, b in ((-arm, -r), (r, arm))]
    builder.add(metal, *pieces, link=name, handle=True)
    builder.knob(name, (x, y, top), (0, 0, -1), 3.1, friction=0.03, at=(x + arm, y, bars[1]))
