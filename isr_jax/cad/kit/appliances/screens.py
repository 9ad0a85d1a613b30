"""Monitors and televisions, on a stand or on a wall.

Screens are 16:9 (or 21:9), sized by their diagonal: 22 to 34 inches on desks, 32 to 75 inches in
living rooms; panels are 25 to 60 mm thick (makers' catalogues).
"""

from __future__ import annotations

from typing import Literal

from .. import materials as m
from ..builder import ModelBuilder
from ..furniture.panels import Bounds
from ..solids import box

_RIM_M = 0.004
_BEZEL_M = 0.008


def monitor(
    width: float,
    depth: float,
    height: float,
    *,
    lift: float = 0.12,
    thickness: float = 0.045,
    stand: Literal["plate", "feet"] = "plate",
    shell: m.Material = m.DISPLAY_SHELL,
) -> ModelBuilder:
    """A screen on a stand as deep as the box, its lower edge ``lift`` above what it stands on."""
    builder = ModelBuilder("monitor", symmetry=1)
    x, front = width / 2, min(0.45 * depth, depth - thickness - 0.03)
    _add_panel(builder, x, (lift, height), thickness, shell)
    if stand == "plate":
        half, tall = min(0.14, 0.5 * x), height - lift
        plate = box((-half, half), (-front, depth - front), (0.0, 0.004))
        builder.add(m.STEEL, plate, carries=False)
        neck = (thickness, thickness + 0.03)
        builder.add(shell, box((-0.03, 0.03), neck, (0.004, lift + 0.5 * tall)))
        return builder
    for side in (-1, 1):
        c = side * 0.72 * x
        span = (c - 0.015, c + 0.015)
        builder.add(shell, box(span, (-front, depth - front), (0.0, 0.012)), carries=False)
        builder.add(shell, box(span, (0.0, 0.6 * thickness), (0.012, lift)))
    return builder


def wall_screen(
    width: float,
    depth: float,
    height: float,
    *,
    gap: float = 0.03,
    shell: m.Material = m.DISPLAY_SHELL,
) -> ModelBuilder:
    """A screen on a wall plate, ``gap`` before the wall."""
    builder = ModelBuilder("monitor", symmetry=1, mount="wall")
    x, thickness = width / 2, depth - gap - _RIM_M
    _add_panel(builder, x, (0.0, height), thickness, shell)
    half, tall = min(0.22, 0.4 * x), min(0.2, 0.4 * height)
    middle = (0.45 * height - tall / 2, 0.45 * height + tall / 2)
    back = thickness + gap
    for side in (-1, 1):
        arm = (side * half - 0.02, side * half + 0.02)
        builder.add(m.STEEL_TUBE, box(arm, (thickness, back - 0.005), middle), carries=False)
    plate = (-half - 0.05, half + 0.05)
    builder.add(m.STEEL_TUBE, box(plate, (back - 0.005, back), middle), carries=False)
    return builder


def _add_panel(builder: ModelBuilder, x: float, z: Bounds, thickness: float, shell) -> None:
    """The screen proud of its shell, which is thickest in the middle of its back."""
    z0, z1 = z
    tall, middle = z1 - z0, 0.6 * thickness
    inner = (z0 + _BEZEL_M, z1 - _BEZEL_M)
    builder.add(m.SCREEN, box((-x + _BEZEL_M, x - _BEZEL_M), (-_RIM_M, 0.0), inner))
    builder.add(shell, box((-x, x), (0.0, middle), z))
    back = (z0 + 0.1 * tall, z0 + 0.8 * tall)
    builder.add(shell, box((-0.7 * x, 0.7 * x), (middle, thickness), back))
