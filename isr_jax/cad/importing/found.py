"""What a reader says of one foreign model: its shape, and what its file states about it."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float

from ...classes import Mount
from ...robot_model import RobotModel

Vector = Float[np.ndarray, "3"]


@dataclasses.dataclass(frozen=True, eq=False)
class FoundModel:
    """One model in its file's own frame and unit. What the file does not state is None."""

    name: str
    source: str
    """File and entry, for messages and for the model's record."""
    robot: RobotModel
    """Hulls only where the file states collision shapes; mass 0 where it states none."""
    unit_m: float | None = None
    """Metres per unit of length."""
    up: Vector | None = None
    """Unit, file frame."""
    front: Vector | None = None
    """Unit, file frame: where the model faces."""
    size_m: Vector | None = None
    """Stated width (left to right), depth (front to back) and height, metres."""
    class_name: str | None = None
    """Class of the table, where the file names one that maps to it without guessing."""
    tags: tuple[str, ...] = ()
    """Categories, keywords, folder names: what a class may be guessed from, best first."""
    licence: str | None = None
    creator: str | None = None
    mass_kg: float | None = None
    mount: Mount | None = None
    elevation_m: float | None = None
    """Stated height of its underside above the floor: hung, or put on something."""
    handles: dict[str, Vector] = dataclasses.field(default_factory=dict)
    """Stated handle of a joint, by the joint's name: point in its child link's frame."""
    notes: tuple[str, ...] = ()
    """What was repaired or left out while reading."""
