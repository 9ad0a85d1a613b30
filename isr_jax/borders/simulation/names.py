"""Border: MuJoCo. Names of bodies and joints, also of those that have none."""

# MuJoCo's compiled names have no stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Sequence

import mujoco

from ...errors import SceneError

_KINDS = {"body": mujoco.mjtObj.mjOBJ_BODY, "joint": mujoco.mjtObj.mjOBJ_JOINT}
_LISTED = 12
"""Names that an error lists."""


def body_name(model: mujoco.MjModel, row: int) -> str:
    """Name of a body, or ``#`` and its number."""
    return mujoco.mj_id2name(model, _KINDS["body"], int(row)) or f"#{int(row)}"


def joint_name(model: mujoco.MjModel, row: int) -> str:
    """Name of a joint, or ``#`` and its number."""
    return mujoco.mj_id2name(model, _KINDS["joint"], int(row)) or f"#{int(row)}"


def body_row(model: mujoco.MjModel, name: str) -> int:
    """Number of the body of a name that `body_name` gave.

    Raises:
        SceneError: no body has that name.
    """
    return _row("body", name, [body_name(model, i) for i in range(model.nbody)])


def joint_row(model: mujoco.MjModel, name: str) -> int:
    """Number of the joint of a name that `joint_name` gave.

    Raises:
        SceneError: no joint has that name.
    """
    return _row("joint", name, [joint_name(model, i) for i in range(model.njnt)])


def _row(kind: str, name: str, names: Sequence[str]) -> int:
    if name not in names:
        listed = ", ".join(names[:_LISTED]) + (", ..." if len(names) > _LISTED else "")
        raise SceneError(f"no {kind} is called {name!r}", f"use one of: {listed or 'none'}")
    return names.index(name)
