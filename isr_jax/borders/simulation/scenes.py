"""Border: MuJoCo. Scenes from files and from memory, and which of their bodies stand free."""

# MuJoCo's compiled names have no stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeAlias

import mujoco
import numpy as np
from jaxtyping import Float

from ...errors import SceneError
from .names import body_name

if TYPE_CHECKING:  # MuJoCo ships no types: to a type checker its classes are unknown
    SceneSource: TypeAlias = str | Path | Any
else:
    SceneSource = str | Path | mujoco.MjSpec | mujoco.MjModel
"""An MJCF or URDF file, or a scene that is already in memory."""


def load_model(scene: SceneSource) -> mujoco.MjModel:
    """Compile a scene; an `MjModel` is handed back as it is.

    Args:
        scene: Path of an MJCF or URDF file, an `MjSpec` (left unchanged), or an `MjModel`.

    Raises:
        SceneError: there is no such file, or MuJoCo cannot compile it; with MuJoCo's reason.
    """
    if isinstance(scene, mujoco.MjModel):
        return scene
    try:
        if isinstance(scene, mujoco.MjSpec):
            return scene.copy().compile()
        return mujoco.MjModel.from_xml_path(str(_existing(scene)))
    except ValueError as error:
        raise _refusal(scene, error) from None


def freed_model(scene: SceneSource, anchored: Sequence[str]) -> mujoco.MjModel:
    """The scene with a free joint on every top-level body that is fixed to the world.

    Bodies without mass, mocap bodies and the ``anchored`` stay fixed; a body that hangs on the
    world by joints of its own keeps them. Keyframes are dropped: they state fewer positions.

    Args:
        scene: Path of an MJCF or URDF file, or an `MjSpec` (left unchanged).
        anchored: Names of bodies that stay fixed.

    Raises:
        SceneError: there is no such file, MuJoCo cannot compile it, or it is an `MjModel`, to
            which no joint can be added.
    """
    if isinstance(scene, mujoco.MjModel):
        raise SceneError(
            f"{scene_label(scene)} is compiled: no joint can be added to it",
            "give the file that it was loaded from, or its MjSpec",
        )
    try:
        spec = (
            scene.copy()
            if isinstance(scene, mujoco.MjSpec)
            else mujoco.MjSpec.from_file(str(_existing(scene)))
        )
        model = spec.compile()
        held = {*anchored, *unfreeable_bodies(model)}
        loose = {row for row in _static_rows(model) if body_name(model, row) not in held}
        for body in [b for b in spec.bodies if b.id in loose]:
            body.add_freejoint(name=f"{body_name(model, body.id)}_freed")
        for key in list(spec.keys):
            spec.delete(key)
        return spec.compile()
    except ValueError as error:
        raise _refusal(scene, error) from None


def _existing(path: str | Path) -> Path:
    if not Path(path).is_file():
        raise SceneError(
            f"{path} is not a file",
            "give the scene.xml that `isr run` wrote, or another MJCF or URDF file",
        )
    return Path(path)


def _refusal(scene: SceneSource, error: ValueError) -> SceneError:
    return SceneError(
        f"{scene_label(scene)}: {error}", "mend what MuJoCo names, or export the scene again"
    )


def is_compiled(scene: SceneSource) -> bool:
    """Whether a scene is an `MjModel`, to which nothing can be added."""
    return isinstance(scene, mujoco.MjModel)


def scene_label(scene: SceneSource) -> str:
    """What to call a scene: its path, or ``MjModel`` or ``MjSpec`` and the model's name."""
    if isinstance(scene, mujoco.MjModel):
        return f"MjModel {scene.names.split(bytes(1))[0].decode() or 'without a name'}"
    if isinstance(scene, mujoco.MjSpec):
        return f"MjSpec {scene.modelname or 'without a name'}"
    return str(scene)


def free_bodies(model: mujoco.MjModel) -> tuple[str, ...]:
    """Names of the bodies with a free joint, in the order of the model."""
    return tuple(body_name(model, row) for row in free_rows(model))


def free_rows(model: mujoco.MjModel) -> list[int]:
    """Numbers of the bodies with a free joint, in the order of the model's joints."""
    return model.jnt_bodyid[model.jnt_type == mujoco.mjtJoint.mjJNT_FREE].tolist()


def static_bodies(model: mujoco.MjModel) -> tuple[str, ...]:
    """Names of the top-level bodies that are fixed to the world."""
    return tuple(body_name(model, row) for row in _static_rows(model))


def _static_rows(model: mujoco.MjModel) -> list[int]:
    top = [i for i in range(1, model.nbody) if model.body_parentid[i] == 0]
    return [i for i in top if model.body_jntnum[i] == 0]


def unfreeable_bodies(model: mujoco.MjModel) -> tuple[str, ...]:
    """Names of the fixed bodies that cannot be freed: mocap bodies, and those without any mass,
    also in what is welded to them (layout in our scenes)."""
    mass_kg = np.array(model.body_mass, np.float64)
    for row in range(model.nbody - 1, 0, -1):  # children come after their parents
        if model.body_jntnum[row] == 0 and model.body_parentid[row] != 0:
            mass_kg[model.body_parentid[row]] += mass_kg[row]
    rows = [i for i in _static_rows(model) if mass_kg[i] == 0 or model.body_mocapid[i] >= 0]
    return tuple(body_name(model, row) for row in rows)


def bounds(
    model: mujoco.MjModel, margin_m: float
) -> tuple[Float[np.ndarray, "3"], Float[np.ndarray, "3"]]:
    """Axis-aligned box about all geoms at the start, world frame, grown by a margin.

    Args:
        model: Of the scene. MuJoCo gives an endless plane no extent: it counts as its middle.
        margin_m: Added on every side, metres.

    Returns:
        The lowest and the highest corner, metres.
    """
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    if model.ngeom == 0:
        return np.full(3, -margin_m), np.full(3, margin_m)
    center, half = model.geom_aabb[:, :3], model.geom_aabb[:, 3:]
    turn = data.geom_xmat.reshape(-1, 3, 3)
    middle = data.geom_xpos + np.einsum("gij,gj->gi", turn, center)
    reach = np.einsum("gij,gj->gi", np.abs(turn), half)
    return (middle - reach).min(0) - margin_m, (middle + reach).max(0) + margin_m
