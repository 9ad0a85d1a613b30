"""A model of the kit made at another size: boards and handles keep their thickness."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence

import numpy as np

from ...errors import SettingError
from ...library import CadModel
from .builder import ModelBuilder
from .catalogue import row_of
from .rows import Row

FIT_RANGE = (0.6, 1.6)
"""Times the catalogue's size, along each axis: beyond it, other models are the better start."""
_CLOSE_M = 1e-4
_STEPS = 12
_AXES = ("width", "depth", "height")


def fit_cad(model: CadModel | str, size: Sequence[float], *, detail: str = "medium") -> CadModel:
    """Make a model of the kit at ``size`` instead of stretching it.

    The maker is called with other dimensions; where the box that comes out differs from what
    was asked, it is asked for that much more, until they agree within 0.1 mm.

    Args:
        model: One of the kit, or its id.
        size: Width, depth and height of the box, joints closed and handles left out, metres.
        detail: Of round parts.

    Returns:
        The model; its id is that of the original with its size in millimetres behind it.

    Raises:
        SettingError: the kit makes no such model, or cannot make it at that size.
    """
    cad_id = model if isinstance(model, str) else model.id
    row, asked = row_of(cad_id), np.asarray(size, np.float64)
    _refuse_far_sizes(cad_id, row, asked)
    design = _design(cad_id, row, asked, detail)
    millimetres = "x".join(str(round(1000 * v)) for v in asked.tolist())
    fitted = design.build(f"{row.name}_{millimetres}")
    return dataclasses.replace(fitted, notes=(f"{cad_id} made at {millimetres} mm",))


def _refuse_far_sizes(cad_id: str, row: Row, asked: np.ndarray) -> None:
    if asked.shape != (3,):
        raise SettingError(f"size {asked.tolist()} for {cad_id}", "give width, depth and height")
    for axis, value, own in zip(_AXES, asked.tolist(), row.size):
        low, high = (round(f * own, 3) for f in FIT_RANGE)
        if not low - _CLOSE_M <= value <= high + _CLOSE_M:
            problem = f"{axis} {value:.4g} m for {cad_id}, which is {own:g} m"
            raise SettingError(problem, f"give {low:g} to {high:g} m, or fit another model")


def _design(cad_id: str, row: Row, asked: np.ndarray, detail: str) -> ModelBuilder:
    """The design whose box is the asked one (fixed point on the maker's arguments)."""
    given = asked.copy()
    for _ in range(_STEPS):
        width, depth, height = np.round(given, 6).tolist()
        design = row.design((width, depth, height), detail)
        missing = asked - design.size
        if np.abs(missing).max() <= _CLOSE_M:
            return design
        given += missing
    off = " x ".join(f"{1000 * v:+.1f}" for v in missing.tolist())
    problem = f"{cad_id} cannot be made at {asked.tolist()} m: its box is off by {off} mm"
    raise SettingError(problem, "ask for a size nearer to the catalogue's")
