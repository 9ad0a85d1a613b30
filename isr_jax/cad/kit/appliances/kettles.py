"""Kettles: electric jugs on a stand, and kettles for a stove.

They hold 1.0 to 1.8 l: 0.15 to 0.17 m wide without handle and spout, 0.22 to 0.27 m high, 0.8 to
1.3 kg (EN 60335-2-15 and makers' catalogues). The spout points to -x, the handle to +x.
"""

from __future__ import annotations

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..shapes.shells import Level, arch, layered_wall, loft, slanted_box, turned
from ..solids import ROUND_SIDES, box, circle, frustum, prism

_GAP_M = 0.0025
_WALL_M = 0.003
_HANDLE_M = 0.055
"""How far the handle of a jug stands out."""
_SPOUT_M = 0.03
_LID_M = 0.014
_ARCH_M = 0.012
_ARCH_RISE_M = 0.035
"""Of the middle of a bent handle over the rim, so that the lid opens below it."""


def jug_kettle(
    width: float,
    depth: float,
    height: float,
    *,
    stand: float = 0.025,
    top: float = 0.8,
    body: m.Material = m.KETTLE_STEEL,
    trim: m.Material = m.BLACK_PLASTIC,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A hollow jug on its stand, ``top`` times as wide at its rim; the lid opens at the handle."""
    builder = ModelBuilder("kettle", symmetry=1)
    rx, ry = (width - _HANDLE_M - _SPOUT_M) / 2, depth / 2
    rim, low = height - _LID_M - _GAP_M, stand + 0.008
    outline = circle((rx, ry), sides)
    builder.add(
        m.BLACK_CASE, frustum(((rx, ry), (0.94 * rx, 0.94 * ry)), (0.0, stand), sides=sides)
    )
    start = 1.0 - (1.0 - top) * 0.05
    t = _WALL_M / min(rx, ry)
    builder.add(body, loft(0.97 * outline, start * outline, (stand, low)))
    levels = [Level(low, start, start - t), Level(rim, top, top - t)]
    builder.add(body, *layered_wall(outline, outline, levels))
    _add_lid(builder, (top * rx, top * ry), (rim + _GAP_M, height), (0.0, top * rx), trim, sides)

    def edge(z: float) -> float:
        return rx * (start + (top - start) * (z - low) / (rim - low))

    _add_jug_handle(builder, edge, rx + _HANDLE_M, (low, rim), trim)
    lip = rim - 0.2 * (rim - low)
    # A wedge that is flush with the wall, its outline given as (z, x).
    wedge = [(lip, -edge(lip)), (rim, -rx - _SPOUT_M), (rim, -edge(rim))]
    builder.add(body, prism(wedge, "y", (-0.018, 0.018)), carries=False)
    return builder


def _add_jug_handle(builder, edge, end: float, z: tuple[float, float], trim) -> None:
    """A grip beside the wall, between two arms that meet it."""
    low, high = z
    tall, half, grip = high - low, 0.011, 0.018
    arms = [(low + 0.12 * tall, low + 0.12 * tall + 0.02), (high - 0.035, high - 0.015)]
    for a, b in arms:
        foot, head = ((edge(v), end - grip) for v in (a, b))
        arm = slanted_box((foot, (-half, half)), (head, (-half, half)), (a, b))
        builder.add(trim, arm, carries=False)
    bar = box((end - grip, end), (-half, half), (arms[0][0], arms[1][1]))
    builder.add(trim, bar, carries=False)


def _add_lid(
    builder: ModelBuilder,
    radii: tuple[float, float],
    z: tuple[float, float],
    spot: tuple[float, float],
    trim: m.Material,
    sides: int,
) -> None:
    """A cap with a knob that turns about its edge at +x; ``spot`` is (middle, edge) along x."""
    middle, edge = spot
    rx, ry = radii
    cap = frustum(((rx, ry), (0.9 * rx, 0.9 * ry)), z, (middle, 0.0), sides)
    builder.add(m.BLACK_CASE, cap, link="lid", carries=False)
    tall = round(min(0.014, 0.4 * rx), 4)
    knob = frustum((0.55 * tall, 0.85 * tall), (z[1], z[1] + tall), (middle, 0.0), sides)
    builder.add(trim, knob, link="lid", handle=True)
    at = (middle - 0.9 * rx, 0.0, z[1])
    builder.hinge("lid", (edge, 0.0, z[0]), (0, 1, 0), 1.2, damping=0.004, friction=0.02, at=at)


def stove_kettle(
    width: float,
    depth: float,
    height: float,
    *,
    body: m.Material = m.KETTLE_STEEL,
    trim: m.Material = m.BLACK_PLASTIC,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A low, wide kettle with a long spout, a lid on top and an arched handle over it."""
    builder = ModelBuilder("kettle", symmetry=1)
    spout, foot = 0.05, 0.006
    rx, ry = (width - spout) / 2, depth / 2
    bend = round(min(0.62 * rx, 0.33 * height), 4)
    neck = 0.48 * bend / rx
    rise = min(_ARCH_RISE_M, 0.15 * height)
    rim = height - bend - _ARCH_M - rise
    outline, t = circle((rx, ry), sides), _WALL_M / min(rx, ry)
    levels = [Level(foot, 0.93, 0.93 - t), Level(round(0.5 * rim, 4), 1.0, 1.0 - t)]
    levels += [Level(round(0.82 * rim, 4), 0.86, 0.86 - t), Level(rim, neck, neck - t)]
    builder.add(body, loft(0.9 * outline, 0.93 * outline, (0.0, foot)))
    builder.add(body, *layered_wall(outline, outline, levels), carries=False)
    lid = (rim + _GAP_M, rim + _GAP_M + 0.01)
    _add_lid(builder, (neck * rx, neck * ry), lid, (0.0, neck * rx), trim, sides)

    def edge(z: float) -> float:
        return rx * float(np.interp(z, [v.z for v in levels], [v.outer for v in levels]))

    _add_arch(builder, edge, (levels[2].z, rim, rim + rise), bend, trim)
    low, high, tip = levels[1].z, levels[2].z, rx + spout
    # From the wall up to the level of the rim, its outline given as (z, x).
    beak = [(low, -edge(low)), (rim - 0.012, -tip), (rim, 0.02 - tip), (high, -edge(high))]
    builder.add(body, prism(beak, "y", (-0.013, 0.013)), carries=False)
    return builder


def _add_arch(builder: ModelBuilder, edge, z, bend: float, trim) -> None:
    """Legs that stand on the shoulder, and a bend from one to the other along x."""
    (shoulder, rim, center), half = z, 0.009
    near, far = bend, bend + _ARCH_M
    slope = (rim - shoulder) / (edge(shoulder) - edge(rim))
    feet = [shoulder + (edge(shoulder) - r) * slope for r in (near, far)]
    # Outlines given as (z, x).
    right = [(feet[0], near), (center, near), (center, far), (feet[1], far)]
    left = [(z, -x) for z, x in right[::-1]]
    for leg in (left, right):
        builder.add(trim, prism(leg, "y", (-half, half)), carries=False)
    bow = arch((0.0, center), (near, far), (0.0, np.pi), (-half, half))
    builder.add(trim, *(turned(p, "z", np.pi / 2, (0.0, 0.0, 0.0)) for p in bow), carries=False)
