"""Cups, bowls and bottles.

Mugs hold 0.2 to 0.4 l: 80 to 105 mm high, 75 to 95 mm wide, walls of 4 mm; bowls are 110 to
300 mm wide and a third to half as high. Wine bottles of 0.75 l are 73 to 78 mm wide and 290 to
330 mm high (CETIE's Bordeaux and Burgundy moulds) and weigh 1.2 kg full; necks are 28 to 38 mm.
"""

from __future__ import annotations

import numpy as np

from ....errors import SettingError
from .. import materials as m
from ..builder import BASE, ModelBuilder
from ..shapes.turned import Profile, inner_radii, rounds_of, shell, stack
from ..solids import ROUND_SIDES, box

_CAP_GAP_M = 0.002


def cup(
    width: float,
    depth: float,
    height: float,
    *,
    foot: float = 1.0,
    wall: float = 0.004,
    bottom: float = 0.005,
    handle: bool = True,
    material: m.Material = m.CERAMIC,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A hollow cup; its foot is ``foot`` times as wide as its rim, its handle at +x."""
    symmetry, squeeze = rounds_of(width, depth)
    builder = ModelBuilder("cup", symmetry=1 if handle else symmetry)
    rim = width / 2

    def radius(z: float) -> float:
        return rim * (foot + (1 - foot) * z / height)

    floor = [(0.0, radius(0.0)), (bottom, radius(bottom))]
    builder.add(material, *stack(floor, squeeze=squeeze, sides=sides))
    wall_profile = [(bottom, radius(bottom)), (height, rim)]
    hollow = [r - wall for _, r in wall_profile]
    builder.add(material, *shell(wall_profile, hollow, squeeze=squeeze, sides=sides))
    if handle:
        r, heights = 0.0045, (0.25 * height, 0.8 * height)
        end = round(max(radius(z) for z in heights) + 0.024, 4)
        bar = box((end, end + 0.007), (-r, r), (heights[0] - r, heights[1] + r))
        builder.add(material, bar, handle=True)
        for z in heights:
            start = float(np.ceil(1e4 * max(radius(z - r), radius(z + r))) / 1e4)
            builder.add(material, box((start, end), (-r, r), (z - r, z + r)), handle=True)
    return builder


def bowl(
    width: float,
    depth: float,
    height: float,
    *,
    foot: float = 0.45,
    curve: float = 1.0,
    wall: float = 0.004,
    bottom: float = 0.006,
    rings: int = 3,
    material: m.Material = m.CERAMIC,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A hollow bowl on a foot ``foot`` times as wide as its rim.

    ``curve`` runs from 0, a cone, to 1, a wall that ends upright.
    """
    symmetry, squeeze = rounds_of(width, depth)
    builder = ModelBuilder("bowl", symmetry=symmetry)
    rim = width / 2

    def radius(z: float) -> float:
        t = z / height
        arched = np.sqrt(1 - (1 - foot**2) * (1 - t) ** 2)
        return rim * float(curve * arched + (1 - curve) * (foot + (1 - foot) * t))

    # Lower rings are lower ones: there the wall bends most.
    steps = np.linspace(0.0, 1.0, rings + 1) ** (1 + curve)
    profile = [(z, radius(z)) for z in np.round(bottom + (height - bottom) * steps, 5).tolist()]
    floor = [(0.0, radius(0.0)), profile[0]]
    builder.add(material, *stack(floor, squeeze=squeeze, sides=sides))
    hollow = inner_radii(profile, wall)
    builder.add(material, *shell(profile, hollow, squeeze=squeeze, sides=sides))
    return builder


def bottle(
    width: float,
    depth: float,
    height: float,
    *,
    neck: float = 0.03,
    shoulder: float = 0.58,
    throat: float = 0.74,
    cap: float = 0.03,
    label: tuple[float, float] | None = (0.18, 0.5),
    material: m.Material = m.WINE_BOTTLE,
    cap_material: m.Material = m.RED_COVER,
    label_material: m.Material = m.PAPER,
    screw: bool = False,
    wall: float = 0.0,
    sides: int = ROUND_SIDES,
) -> ModelBuilder:
    """A bottle, full and capped, or empty and open.

    Args:
        width: Of the body.
        depth: Of the body.
        height: With the cap.
        neck: Width of the neck, metres; at most four fifths of the body's.
        shoulder: Share of the height below the shoulder.
        throat: Share of the height where the neck begins.
        cap: Height of the cap, metres.
        label: Shares of the height between which a label goes round; None: no label.
        material: Of body and neck; its density is that of glass and contents together.
        cap_material: Of the cap.
        label_material: Of the label.
        screw: The cap turns: a knob with 2 mm below it.
        wall: Above 0 the bottle is hollow and open, without cap and label.
        sides: Of round parts.

    Raises:
        SettingError: The cap leaves no room for the throat, or the label none between foot and
            shoulder.
    """
    symmetry, squeeze = rounds_of(width, depth)
    builder = ModelBuilder("bottle", symmetry=symmetry)
    body = width / 2
    narrow = min(neck / 2, 0.8 * min(1.0, squeeze) * body)
    low, high = round(shoulder * height, 4), round(throat * height, 4)
    end = height if wall else height - cap - (_CAP_GAP_M if screw else 0.0)
    if high >= end:
        problem = f"a bottle {height:.3g} m high with a cap of {cap:.3g} m"
        raise SettingError(problem, "ask for a higher bottle, or for a lower cap or throat")
    middle = (round((low + high) / 2, 4), round(narrow + 0.72 * (body - narrow), 4))
    profile = [(0.0, 0.94 * body), (0.02 * height, body), (low, body), middle, (high, narrow)]
    profile.append((end, narrow))
    if wall:
        _add_hollow(builder, material, profile, wall, squeeze, sides)
        return builder
    for part, band in _banded(profile, label, height):
        chosen = label_material if band else material
        builder.add(chosen, *stack(part, squeeze=squeeze, sides=sides))
    link = "cap" if screw else BASE
    top = [(height - cap, narrow + 0.001), (height, narrow + 0.001)]
    builder.add(cap_material, *stack(top, squeeze=squeeze, sides=sides), link=link)
    if screw:
        grip = (narrow + 0.001, 0.0, height - cap / 2)
        builder.knob(link, (0.0, 0.0, height - cap / 2), (0, 0, 1), 9.42, at=grip)
    return builder


def _add_hollow(builder, material, profile: Profile, wall: float, squeeze, sides) -> None:
    thick = (profile[1][0], profile[1][1])
    builder.add(material, *stack([profile[0], thick], squeeze=squeeze, sides=sides))
    hollow = [r - wall for _, r in profile[1:]]
    builder.add(material, *shell(profile[1:], hollow, squeeze=squeeze, sides=sides))


def _banded(profile: Profile, label: tuple[float, float] | None, height: float):
    """The profile cut at the label's ends: (part, whether it is the label) from below."""
    if label is None:
        return [(profile, False)]
    low, high = (round(share * height, 4) for share in label)
    radius = profile[1][1]
    if not profile[1][0] < low < high <= profile[2][0]:
        problem = f"a label from {low:.3g} m to {high:.3g} m"
        raise SettingError(problem, "keep it between the foot and the shoulder of the bottle")
    above = [(high, radius), *(p for p in profile if p[0] > high)]
    return [
        ([*profile[:2], (low, radius)], False),
        ([(low, radius), (high, radius)], True),
        (above, False),
    ]
