"""A model at a place in a room that is being furnished."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float

from ...library import CadModel
from ...types import Attachment

ON_FLOOR, ON_NOTHING = -1, -2
"""Parents of proposals that no other thing carries."""


@dataclasses.dataclass(frozen=True, eq=False)
class Proposal:
    """A model, scaled, at a place in the room's frame."""

    model: CadModel
    scale: float
    yaw: float
    center: Float[np.ndarray, "3"]
    parent: int
    """Position of what carries it in `Occupancy.placed`, `ON_FLOOR` or `ON_NOTHING`; for what
    leans, what its lower edge stands on."""
    plane: int = 0
    """Plane of the parent's model that carries it."""
    attachment: Attachment = "none"
    lean: Float[np.ndarray, "3 3"] | None = None
    """How it is turned before the yaw; None: upright."""
    role: str = ""
    """Of `ROLES`."""

    @property
    def R_room(self) -> Float[np.ndarray, "3 3"]:
        """The model's axes in the room's frame."""
        R = np.eye(3)
        R[:2, :2] = rotation_2d(self.yaw)
        return R if self.lean is None else R @ self.lean

    def to_room(self, points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 3"]:
        """Points of the model's canonical frame, in the room's."""
        return self.scale * points @ self.R_room.T + self.center

    def from_room(self, points: Float[np.ndarray, "points 3"]) -> Float[np.ndarray, "points 3"]:
        """Points of the room in the model's canonical frame, unscaled."""
        return (points - self.center) @ self.R_room / self.scale


def rotation_2d(yaw: float) -> Float[np.ndarray, "2 2"]:
    """Turn by ``yaw`` radians in the plane of the floor."""
    c, s = np.cos(yaw), np.sin(yaw)
    return np.array([[c, -s], [s, c]])
