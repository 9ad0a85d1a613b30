"""Border: a model alone in MuJoCo: it stands in its mount, and a hand opens its joints (mujoco).

Two compilations of a model. *Held*: the base is part of the world, and no pair of links is left out
of collision, neither MuJoCo's parents and children nor the pairs across a joint that exports
exclude; so a door is stopped by its own carcass. *Free*: as exported, on a floor with a free joint,
or, where the mount is a wall or an opening, a body that a weld holds.
"""

# MuJoCo's compiled names have no stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import dataclasses
import tempfile
from pathlib import Path

import mujoco
import numpy as np

from ...library import CadModel, Handle
from ...robot_model import Joint, RobotModel, link_transforms
from ...robot_model.mesh_files import MeshFiles
from ...robot_model.mjcf import ContactModel, add_robot, set_contact
from ...robot_model.naming import named_in_scene
from ..poses import travel_range
from .hand import FLOOR, Contacts, Hand, Travel
from .settings import CheckSettings

STANDING_MOUNTS = ("floor", "surface")
"""Mounts in which nothing holds a model but its weight."""
_ROOT = "model"


@dataclasses.dataclass(frozen=True)
class Overlap:
    """The deepest contact between two links while a joint moved."""

    link_a: str
    link_b: str
    depth_m: float
    position: float
    """Of the moved joint, radians or metres."""


@dataclasses.dataclass(frozen=True, eq=False)
class _Compiled:
    """A model in MuJoCo, and whose each geom is."""

    mujoco: mujoco.MjModel
    owner: np.ndarray
    """Row of ``labels`` a geom."""
    labels: tuple[str, ...]
    """The floor, the base, then the other links."""

    def contacts(self, data: mujoco.MjData) -> Contacts:
        """Depth of the deepest contact between each two that touch, other than base and floor."""
        found: Contacts = {}
        if data.ncon == 0:
            return found
        owners, depth = self.owner[data.contact.geom], -data.contact.dist
        for k in np.flatnonzero((depth > 0) & (owners.max(1) > 1)):
            a, b = sorted(self.labels[i] for i in owners[k])
            found[a, b] = max(found.get((a, b), 0.0), float(depth[k]))
        return found


class ModelPhysics:
    """One model, compiled held and free; raises `ValueError` where MuJoCo refuses it."""

    def __init__(self, model: CadModel, settings: CheckSettings) -> None:
        self._model, self._settings = model, settings
        self._robot = named_in_scene(_without_visuals(model.robot), _ROOT)
        self._labels = (FLOOR, *(link.name for link in model.robot.links))
        with tempfile.TemporaryDirectory() as folder:
            files = MeshFiles(Path(folder))
            self._held = self._compiled(files, free=False)
            self._free = self._compiled(files, free=True)

    def _compiled(self, files: MeshFiles, *, free: bool) -> _Compiled:
        settings = self._settings
        contact = ContactModel(solref=(max(0.005, 2 * settings.timestep_s), 1.0))
        spec = _empty_spec(files.folder, settings.timestep_s)
        pose = np.eye(4)
        pose[2, 3] = -lowest_point(self._robot)
        add_robot(spec, self._robot, pose, free=free, files=files, contact=contact)
        if not free:
            spec.option.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_FILTERPARENT)
            for pair in list(spec.excludes):
                spec.delete(pair)
        elif self._model.mount in STANDING_MOUNTS:
            plane = mujoco.mjtGeom.mjGEOM_PLANE
            set_contact(spec.worldbody.add_geom(name=FLOOR, type=plane, size=[0, 0, 1]), contact)
        else:
            _hold(spec)
        compiled = spec.compile()
        rows = {link.name: i + 1 for i, link in enumerate(self._robot.links)}
        bodies = [rows.get(compiled.body(i).name, 0) for i in range(compiled.nbody)]
        return _Compiled(compiled, np.array(bodies)[compiled.geom_bodyid], self._labels)

    def standing_drift_m(self) -> float:
        """Farthest that any corner of any link's box moves, nothing touching the model."""
        stands = self._model.mount in STANDING_MOUNTS
        model = (self._free if stands else self._held).mujoco
        data = mujoco.MjData(model)
        mujoco.mj_forward(model, data)
        corners, rows = self._corners(model)
        start, drift = _placed(data, corners, rows), 0.0
        stride = round(0.02 / self._settings.timestep_s)
        for _ in range(round(self._settings.standing_s / (stride * self._settings.timestep_s))):
            mujoco.mj_step(model, data, stride)
            mujoco.mj_kinematics(model, data)  # a step leaves the poses of before its integration
            moved = np.linalg.norm(_placed(data, corners, rows) - start, axis=-1)
            drift = max(drift, float(moved.max()))
        return drift if np.isfinite(drift) else np.inf

    def _corners(self, model: mujoco.MjModel) -> tuple[np.ndarray, np.ndarray]:
        """Corners [links, 8, 3] of each link's box, and the body of each link [links]."""
        links = [link for link in self._robot.links if link.hulls]
        clouds = [np.concatenate([h.vertices for h in link.hulls]) for link in links]
        ends = np.array([[c.min(0), c.max(0)] for c in clouds], np.float64)
        choice = np.indices((2, 2, 2)).reshape(3, 8).T
        return ends[:, choice, np.arange(3)], np.array([model.body(k.name).id for k in links])

    def overlaps(self, joint: Joint | None = None) -> tuple[Overlap, ...]:
        """Pairs of links that overlap at rest, or anywhere along the travel of a joint.

        By geometry alone: all other joints are closed, nothing is pushed aside.
        """
        model, deepest = self._held.mujoco, {}
        data = mujoco.MjData(model)
        positions, address = np.zeros(1), 0
        if joint is not None:
            positions = np.linspace(*travel_range(joint), self._settings.sweep_positions)
            address = int(model.joint(f"{_ROOT}_{joint.name}").qposadr[0])
        for position in positions:
            if joint is not None:
                data.qpos[address] = position
            mujoco.mj_fwdPosition(model, data)
            for pair, depth in self._held.contacts(data).items():
                if depth > deepest.get(pair, (self._settings.overlap_m, 0.0))[0]:
                    deepest[pair] = (depth, float(position))
        ordered = sorted(deepest.items(), key=lambda item: (-item[1][0], item[0]))
        return tuple(Overlap(a, b, depth, at) for (a, b), (depth, at) in ordered)

    def travel(self, handle: Handle, joint: Joint, *, held: bool) -> Travel:
        """What a hand at the handle reaches; see `check_hand.Hand`."""
        compiled = self._held if held else self._free
        body = self._robot.links[self._labels.index(handle.link) - 1].name
        name = f"{_ROOT}_{joint.name}"
        hand = Hand(compiled.mujoco, name, body, handle.position, self._settings)
        return hand.travel(*travel_range(joint), _ROOT, compiled.contacts)


def _empty_spec(folder: Path, timestep_s: float) -> mujoco.MjSpec:
    """With the solver's options of exported scenes."""
    spec = mujoco.MjSpec()
    spec.meshdir, spec.modelfiledir, spec.compiler.degree = ".", str(folder), False
    spec.option.timestep = timestep_s
    spec.option.integrator = mujoco.mjtIntegrator.mjINT_IMPLICITFAST
    spec.option.cone, spec.option.impratio = mujoco.mjtCone.mjCONE_ELLIPTIC, 10
    return spec


def lowest_point(robot: RobotModel) -> float:
    """Least height of any hull in the root frame, joints at zero, metres."""
    poses = link_transforms(robot)
    return min(
        float((hull.vertices @ poses[link.name][2, :3]).min() + poses[link.name][2, 3])
        for link in robot.links
        for hull in link.hulls
    )


def _without_visuals(robot: RobotModel) -> RobotModel:
    """What is only seen costs time to compile and changes nothing."""
    links = tuple(dataclasses.replace(link, visuals=()) for link in robot.links)
    return dataclasses.replace(robot, links=links)


def _hold(spec: mujoco.MjSpec) -> None:
    """Screws in a wall: a stiff weld of the base to the world, where it stands."""
    weld = spec.add_equality(type=mujoco.mjtEq.mjEQ_WELD, objtype=mujoco.mjtObj.mjOBJ_BODY)
    weld.name, weld.name1 = "screws", _ROOT
    weld.solref, weld.solimp = (0.005, 1.0), (0.99, 0.999, 0.001, 0.5, 2.0)


def _placed(data: mujoco.MjData, corners: np.ndarray, rows: np.ndarray) -> np.ndarray:
    turn = data.xmat[rows].reshape(-1, 3, 3)
    return np.einsum("lij,lkj->lki", turn, corners) + data.xpos[rows, None]
