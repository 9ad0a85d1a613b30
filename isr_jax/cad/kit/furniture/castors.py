"""The foot of office chairs: five arms, each on a castor.

Five arms are what EN 1335-2 asks for against tipping; feet are 0.58 to 0.72 m across, castors 50
to 60 mm high.
"""

from __future__ import annotations

import dataclasses

import numpy as np

from .. import materials as m
from ..builder import ModelBuilder
from ..solids import Solid, circle, prism

_ARMS = 5
_CASTOR_M = 0.05
_HUB_M = 0.045
"""Between the hub's flat sides and its middle: each arm starts at one."""
_HUB_TOP_M = 0.105
_ARM_Z = (_CASTOR_M, 0.08)


def add_star_foot(
    builder: ModelBuilder,
    across: tuple[float, float],
    sides: int,
    material: m.Material = m.BLACK_TUBE,
) -> float:
    """Add a foot that fills a box of ``across`` in x and y; returns the y of its column.

    The hub ends 0.105 m above the floor.
    """
    reach, middle = _reach(across, sides)
    for arm in _arms(reach, middle):
        builder.add(material, arm, carries=False)
    for castor in _castors(reach, middle, sides):
        builder.add(m.CASTOR, castor, carries=False)
    corners = _directions(np.pi / _ARMS) * _HUB_M / np.cos(np.pi / _ARMS)
    hub = prism(np.round(corners + np.array([0, middle]), 6), "z", (_ARM_Z[0], _HUB_TOP_M))
    builder.add(material, hub)
    return middle


def _reach(across: tuple[float, float], sides: int) -> tuple[np.ndarray, float]:
    """How far the castors stand out in x and y, and the y of the middle, so that they fit."""
    unit = np.ones(2)
    points = np.concatenate([c.vertices for c in _castors(unit, 0.0, sides)])
    grown = np.concatenate([c.vertices for c in _castors(2 * unit, 0.0, sides)])
    spans = [np.ptp(p[:, :2], axis=0) for p in (points, grown)]
    reach = 1 + (np.asarray(across) - spans[0]) / (spans[1] - spans[0])
    placed = np.concatenate([c.vertices[:, 1] for c in _castors(reach, 0.0, sides)])
    return reach, round(float(-(placed.min() + placed.max()) / 2), 6)


def _directions(turn_rad: float = 0.0) -> np.ndarray:
    """[arms, 2] unit vectors, the first to the rear."""
    angle = np.pi / 2 + turn_rad + 2 * np.pi * np.arange(_ARMS) / _ARMS
    return np.stack([np.cos(angle), np.sin(angle)], 1)


def _arms(reach: np.ndarray, middle: float) -> list[Solid]:
    """Tapering arms from the hub to above the castors."""
    arms = []
    for along in _directions():
        aside = np.array([-along[1], along[0]])
        end, root = reach * along, _HUB_M * along
        outline = [
            root - 0.02 * aside,
            end - 0.014 * aside,
            end + 0.014 * aside,
            root + 0.02 * aside,
        ]
        arm = prism(np.round(np.array(outline) + np.array([0, middle]), 6), "z", _ARM_Z)
        # Narrow and everywhere: no planes that a scan would show.
        arms.append(dataclasses.replace(arm, curved=frozenset(range(len(arm.faces)))))
    return arms


def _castors(reach: np.ndarray, middle: float, sides: int) -> list[Solid]:
    """A wheel under the end of each arm, all of them rolling to the front and rear."""
    r, half, wheels = _CASTOR_M / 2, 0.016, []
    for along in _directions():
        x, y = np.round(reach * along - 0.4 * r * along + np.array([0, middle]), 6).tolist()
        disc = circle(r, min(sides, 16), (y, r))
        wheel = prism(disc, "x", (x - half, x + half))
        wheels.append(dataclasses.replace(wheel, curved=frozenset(range(len(disc)))))
    return wheels
