"""Border: MuJoCo. Contacts between bodies."""

# MuJoCo's compiled names have no stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import dataclasses

import mujoco

from .names import body_name


@dataclasses.dataclass(frozen=True)
class Touch:
    """The deepest contact between two bodies."""

    body_a: str
    body_b: str
    depth_m: float
    """Positive where they overlap."""
    contacts: int
    """Contact points between the two."""


def touches(model: mujoco.MjModel, data: mujoco.MjData | None = None) -> tuple[Touch, ...]:
    """Contacts of a state, one entry per pair of bodies, deepest first.

    MuJoCo sees no contact between two bodies that are both fixed to the world.

    Args:
        model: Of the scene.
        data: The state; by default the start (``qpos0``). Its contacts are read as they are:
            call ``mj_forward`` after a change of positions.
    """
    state = at_start(model) if data is None else data
    pairs: dict[tuple[int, int], list[float]] = {}
    for contact in state.contact[: state.ncon]:
        a, b = sorted(int(model.geom_bodyid[g]) for g in contact.geom)
        pairs.setdefault((a, b), []).append(-float(contact.dist))
    found = [
        Touch(body_name(model, a), body_name(model, b), max(depths), len(depths))
        for (a, b), depths in pairs.items()
    ]
    return tuple(sorted(found, key=lambda t: (-t.depth_m, t.body_a, t.body_b)))


def at_start(model: mujoco.MjModel) -> mujoco.MjData:
    """The state at ``qpos0``, all quantities worked out."""
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    return data
