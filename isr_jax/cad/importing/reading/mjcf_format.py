"""Border: foreign MJCF as found models (mujoco), compiled from memory alone."""

# MuJoCo's compiled names have no stubs.
# pyright: reportAttributeAccessIssue=false

from __future__ import annotations

import dataclasses
import re

import mujoco
import numpy as np

from ....errors import LibraryError
from ....robot_model import Joint, JointKind, RobotModel
from ..found import FoundModel
from ..names import shown
from .convex_shapes import hull_of
from .files import Files
from .limits import ReadLimits
from .mjcf_geoms import Geoms, pose_of
from .mjcf_text import MjcfText, self_contained
from .rigid import folder_tags, model_name, source_of
from .robot_tree import JointFacts, LinkFacts, assembled
from .separate import separate
from .textures import Images

ROOT_LINK = "world"
_DEFAULT_DENSITY = 1000.0
_JOINT_KINDS: dict[int, JointKind] = {
    int(mujoco.mjtJoint.mjJNT_HINGE): "revolute",
    int(mujoco.mjtJoint.mjJNT_SLIDE): "prismatic",
}
_FREE, _BALL = int(mujoco.mjtJoint.mjJNT_FREE), int(mujoco.mjtJoint.mjJNT_BALL)


def read_mjcf_models(files: Files, name: str, limits: ReadLimits) -> tuple[FoundModel, ...]:
    """The models of a document, one for each group of bodies that stands apart from the others.

    Metres, up against gravity. Raises `LibraryError`.
    """
    text = self_contained(files, name, limits)
    model, stated = _compiled(text, name)
    if model.ngeom == 0:
        raise LibraryError(f"{shown(name)} has no geoms: no faces", "give a document with bodies")
    notes = list(text.notes)
    reader = _Reader(model, stated, text, Images(files, limits, notes), notes)
    called = model_name(name)
    robot = reader.robot(called)
    up = -np.array(model.opt.gravity, np.float64)
    length = float(np.linalg.norm(up))
    up = up / length + 0.0 if length > 0 else np.array([0.0, 0.0, 1.0])
    groups = separate(robot, reader.free)
    return tuple(
        FoundModel(
            name=group.name,
            source=source_of(files, name) + ("" if len(groups) == 1 else f"#{group.name}"),
            robot=group,
            unit_m=1.0,
            up=up,
            tags=(group.name, *_link_words(group), *folder_tags(files, name)),
            notes=tuple(dict.fromkeys(_about(group, notes))),
        )
        for group in groups
    )


def _about(robot: RobotModel, notes: list[str]) -> list[str]:
    """Notes without those of joints and links that another model of the document has."""
    own = {part.name for part in (*robot.joints, *robot.links)}
    named = {"joint", "link", "mass"}
    return [
        note
        for note in notes
        if note.split()[0] not in named
        or own & set(note.replace(":", " ").replace(",", " ").split())
    ]


def _link_words(robot: RobotModel) -> tuple[str, ...]:
    """What the model's links with shapes are called, the root first."""
    words = [_spoken(link.name) for link in robot.links if link.visuals]
    return tuple(dict.fromkeys(word for word in words[:3] if word))


def _spoken(name: str) -> str:
    """A body's name as words: what modellers append to names says nothing of the class."""
    return re.sub(r"(?i)(_|root|body|base|\d)+", " ", name).strip()


def _compiled(text: MjcfText, name: str) -> tuple[mujoco.MjModel, set[str | int]]:
    """The compiled model, and the bodies (by id) whose mass the file states."""
    said: list[str] = []
    for shell in (False, True):
        try:
            spec = mujoco.MjSpec.from_string(text.xml, assets=dict(text.meshes))
            if shell:
                for mesh in spec.meshes:
                    mesh.inertia = mujoco.mjtMeshInertia.mjMESH_INERTIA_SHELL
            model = spec.compile()
            break
        # MuJoCo raises ValueError for most faults, but not for all.
        except Exception as error:
            said.append(" ".join(str(error).split())[:200])
    else:
        problem = f"{shown(name)} does not compile in MuJoCo: {said[0]}"
        raise LibraryError(problem, "repair the document")
    stated = {
        body.id
        for body in spec.bodies
        if body.explicitinertial
        or any(np.isfinite(g.mass) or g.density != _DEFAULT_DENSITY for g in body.geoms)
    }
    return model, stated


class _Reader:
    """Bodies, geoms and joints of one compiled model as links and joints."""

    def __init__(self, model, stated, text: MjcfText, images: Images, notes: list[str]) -> None:
        self._model, self._stated, self._notes = model, stated, notes
        self._geoms = Geoms(model, text, images, notes)
        self.free: set[str] = set()
        """Links of bodies with a free joint."""

    def robot(self, name: str) -> RobotModel:
        links = [LinkFacts(self._body_name(b)) for b in range(self._model.nbody)]
        joints: list[JointFacts] = []
        offset = {0: np.zeros(3)}
        for body in range(1, self._model.nbody):
            offset[body] = self._hang(body, links, joints, offset)
        for body in range(self._model.nbody):
            self._fill(links[body], body, offset[body])
        return assembled(name, links, joints, self._notes)

    def _body_name(self, body: int) -> str:
        return self._model.body(body).name or (f"body_{body}" if body else ROOT_LINK)

    def _hang(self, body: int, links: list, joints: list, offset: dict) -> np.ndarray:
        """Add a body's joints; returns where its link's origin lies in the body's frame.

        A link's origin lies on the axis of its joint. A body with several joints gets a link
        without shape for each but the last.
        """
        model, parent = self._model, int(self._model.body_parentid[body])
        T = pose_of(model.body_pos[body], model.body_quat[body])
        at, before = self._body_name(parent), -offset[parent]
        child = self._body_name(body)
        rows = self._moving(body)
        if not rows:
            T[:3, 3] += before
            axis = np.array([1.0, 0.0, 0.0])
            joints.append(JointFacts(Joint(f"{child}_fixed", "fixed", at, child, T, axis), False))
            return np.zeros(3)
        anchor = np.zeros(3)
        for k, (joint, axis, limited) in enumerate(rows):
            step = T if k == 0 else np.eye(4)
            move = np.eye(4)
            move[:3, 3] = model.jnt_pos[joint.row] - anchor
            pose = step @ move
            if k == 0:
                pose[:3, 3] += before
            anchor = np.array(model.jnt_pos[joint.row], np.float64)
            to = child if k == len(rows) - 1 else f"{child}_{joint.name}"
            if to != child:
                links.append(LinkFacts(to))
            joints.append(JointFacts(joint.as_joint(at, to, pose, axis), limited))
            at = to
        return anchor

    def _moving(self, body: int) -> list[tuple[_JointRow, np.ndarray, bool]]:
        model = self._model
        start, found = int(model.body_jntadr[body]), []
        for row in range(start, start + int(model.body_jntnum[body])):
            kind = int(model.jnt_type[row])
            name = model.joint(row).name or f"{self._body_name(body)}_joint_{row - start}"
            if kind == _FREE:
                self.free.add(self._body_name(body))
                continue
            entry = _JointRow.of(model, row, name)
            self._note_springs(row, name)
            if kind == _BALL:
                self._notes.append(f"joint {name}_x: ball joint {name} made three hinges")
                for k, axis in enumerate(np.eye(3)):
                    hinge = dataclasses.replace(entry, name=f"{name}_{'xyz'[k]}")
                    found.append((hinge, axis, False))
                continue
            axis = np.array(model.jnt_axis[row], np.float64)
            found.append((entry, axis, bool(model.jnt_limited[row])))
        return found

    def _note_springs(self, row: int, name: str) -> None:
        if np.any(np.asarray(self._model.jnt_stiffness[row]) != 0):
            self._notes.append(f"joint {name}: its spring left out")

    def _fill(self, link: LinkFacts, body: int, offset: np.ndarray) -> None:
        """Shapes and mass of a body, in its link's frame."""
        geoms = self._geoms.of_body(body, offset)
        seen = [geom for geom in geoms if geom.seen]
        if geoms and not seen:
            self._notes.append(f"link {link.name} has no visuals: its collision shapes are shown")
            seen = geoms
        link.parts = [part for geom in seen for part in self._geoms.parts(geom)]
        hulls = [hull_of(geom.mesh.vertices) for geom in geoms if geom.collides]
        link.hulls = [hull for hull in hulls if hull is not None]
        self._add_mass(link, body, offset)

    def _add_mass(self, link: LinkFacts, body: int, offset: np.ndarray) -> None:
        model = self._model
        if body == 0 or body not in self._stated or model.body_mass[body] <= 0:
            return
        link.mass_kg = float(model.body_mass[body])
        link.com = np.array(model.body_ipos[body], np.float64) - offset
        R = pose_of(np.zeros(3), model.body_iquat[body])[:3, :3]
        link.inertia = R @ np.diag(np.array(model.body_inertia[body], np.float64)) @ R.T


@dataclasses.dataclass(frozen=True)
class _JointRow:
    """What a compiled model says of one joint."""

    row: int
    name: str
    kind: JointKind
    lower: float
    upper: float
    damping: float
    friction: float

    @staticmethod
    def of(model: mujoco.MjModel, row: int, name: str) -> _JointRow:
        dof, start = int(model.jnt_dofadr[row]), float(model.qpos0[model.jnt_qposadr[row]])
        limited = bool(model.jnt_limited[row])
        kind = _JOINT_KINDS.get(int(model.jnt_type[row]), "revolute")
        if kind == "revolute" and not limited:
            kind = "continuous"
        lower, upper = (float(v) - start for v in model.jnt_range[row])
        return _JointRow(
            row=row,
            name=name,
            kind=kind,
            lower=lower if limited else 0.0,
            upper=upper if limited else 0.0,
            damping=float(np.ravel(model.dof_damping[dof])[0]),
            friction=float(model.dof_frictionloss[dof]),
        )

    def as_joint(self, parent: str, child: str, T: np.ndarray, axis: np.ndarray) -> Joint:
        frame = (self.name, self.kind, parent, child, T, axis)
        return Joint(*frame, self.lower, self.upper, self.damping, self.friction)
