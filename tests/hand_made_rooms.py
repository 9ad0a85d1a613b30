"""Rooms made by hand, thing by thing, for tests that know the answer."""

from __future__ import annotations

import numpy as np

from isr_jax.library import CadModel
from isr_jax.synthetic.room import LayoutPatch, PlacedModel, Room

HALF_M, HEIGHT_M = 2.0, 2.4


def _layout() -> tuple[LayoutPatch, ...]:
    h, z = HALF_M, HEIGHT_M
    ground = [(-h, -h, 0), (h, -h, 0), (h, h, 0), (-h, h, 0)]
    rectangles = [("floor", ground)]
    for i in range(4):
        (bx, by, _), (ax, ay, _) = ground[i], ground[(i + 1) % 4]
        rectangles.append(("wall", [(ax, ay, 0), (bx, by, 0), (bx, by, z), (ax, ay, z)]))
    return tuple(
        LayoutPatch(1 if name == "floor" else 100 + i, name, np.array(corners, np.float32))
        for i, (name, corners) in enumerate(rectangles)
    )


LAYOUT = _layout()
"""A floor called ``floor_1`` and walls ``wall_101`` to ``wall_104``, 4 m by 4 m by 2.4 m."""


def _pose(center) -> np.ndarray:
    T = np.eye(4, dtype=np.float32)
    T[:3, 3] = center
    return T


def placed(id: int, model: CadModel, center, parent: str | None, plane: int = 0) -> PlacedModel:
    """A model at its own size, along the axes; plane 0 of a box is its top."""
    return PlacedModel(
        id=id,
        model=model,
        scale=1.0,
        T_world_cad=_pose(center),
        parent=parent,
        parent_plane=None if parent is None else plane,
        attachment="none",
        tint=np.ones(3, np.float32),
    )


def room_with(*items: PlacedModel) -> Room:
    """These items between bare walls along the axes."""
    return Room(
        name="room_0",
        kind="office",
        seed=0,
        layout=LAYOUT,
        items=items,
        T_world_room=np.eye(4, dtype=np.float32),
        size=np.array([2 * HALF_M, 2 * HALF_M, HEIGHT_M], np.float32),
        T_world_dataset=np.eye(4),
        gravity_dataset=np.array([0.0, 0.0, -1.0]),
    )
