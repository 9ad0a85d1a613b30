"""Links and joints of a robot file put together: names that fit, one root, a tree."""

from __future__ import annotations

import dataclasses

import numpy as np

from ....errors import LibraryError
from ....robot_model import Joint, Link, RobotModel, link_transforms
from ..names import Unique, fit_name
from .joint_facts import sound_joint
from .mesh_parts import MeshPart, as_visuals
from .stated_mass import believable


@dataclasses.dataclass(eq=False)
class LinkFacts:
    """A link as its file states it; part frames are the link's."""

    name: str
    parts: list[MeshPart] = dataclasses.field(default_factory=list)
    hulls: list = dataclasses.field(default_factory=list)
    """Convex meshes; empty where the file has none, or some of its shapes are not convex."""
    mass_kg: float = 0.0
    com: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros(3))
    inertia: np.ndarray = dataclasses.field(default_factory=lambda: np.zeros((3, 3)))
    friction: float = 0.8


@dataclasses.dataclass(frozen=True, eq=False)
class JointFacts:
    """A joint as its file states it."""

    joint: Joint
    limited: bool


def assembled(
    name: str, links: list[LinkFacts], joints: list[JointFacts], notes: list[str]
) -> RobotModel:
    """The robot model, root first, with sound joints and believable masses.

    Raises:
        LibraryError: Links or joints form no tree, or there are no faces at all.
    """
    _check_tree(name, links, joints)
    link_name = _renamed([link.name for link in links], "link", notes)
    joint_name = _renamed([facts.joint.name for facts in joints], "joint", notes)
    unique = Unique()
    made = [_link(facts, link_name[facts.name], unique) for facts in links]
    if not any(link.visuals for link in made):
        raise LibraryError(f"{name} has no shapes: no faces", "give a model with meshes")
    made = believable(made, notes)
    drafts = [
        dataclasses.replace(
            facts.joint,
            name=joint_name[facts.joint.name],
            parent=link_name[facts.joint.parent],
            child=link_name[facts.joint.child],
        )
        for facts in joints
    ]
    children = {joint.child for joint in drafts}
    made.sort(key=lambda link: link.name in children)
    draft = RobotModel(fit_name(name, "model"), tuple(made), tuple(drafts))
    sizes = _moved_sizes(draft)
    sound = [
        sound_joint(joint, facts.limited, sizes[joint.child], notes)
        for joint, facts in zip(drafts, joints)
    ]
    return dataclasses.replace(draft, joints=tuple(sound))


def _check_tree(name: str, links: list[LinkFacts], joints: list[JointFacts]) -> None:
    hint = "give every link but one exactly one parent joint, and every name once"
    names = [link.name for link in links]
    children = [facts.joint.child for facts in joints]
    for kind, found in (
        ("link", names),
        ("joint", [facts.joint.name for facts in joints]),
        ("child link", children),
    ):
        twice = sorted({n for n in found if found.count(n) > 1})
        if twice:
            raise LibraryError(f"{name} has {kind} {twice[0]!r} twice", hint)
    unknown = {n for f in joints for n in (f.joint.parent, f.joint.child)} - set(names)
    if unknown:
        raise LibraryError(f"{name} has joints of unknown links {sorted(unknown)}", hint)
    roots = [n for n in names if n not in set(children)]
    if len(roots) != 1:
        raise LibraryError(f"{name} is no tree of links: its roots are {roots[:5]}", hint)
    parents = {facts.joint.child: facts.joint.parent for facts in joints}
    for start in parents:
        seen, at = {start}, parents[start]
        while at in parents and at not in seen:
            seen.add(at)
            at = parents[at]
        if at in seen:
            raise LibraryError(f"{name} has a loop of links through {at!r}", hint)


def _renamed(names: list[str], kind: str, notes: list[str]) -> dict[str, str]:
    unique = Unique()
    fitted = {n: unique(fit_name(n, kind)) for n in names}
    changed = [f"{old!r} to {new!r}" for old, new in fitted.items() if old != new]
    if changed:
        more = f" and {len(changed) - 3} more" if len(changed) > 3 else ""
        notes.append(f"{kind}s renamed: {', '.join(changed[:3])}{more}")
    return fitted


def _link(facts: LinkFacts, name: str, unique: Unique) -> Link:
    return Link(
        name,
        as_visuals(tuple(facts.parts), unique, name),
        tuple(facts.hulls),
        float(facts.mass_kg),
        np.asarray(facts.com, np.float64),
        np.asarray(facts.inertia, np.float64),
        facts.friction,
    )


def _moved_sizes(robot: RobotModel) -> dict[str, float]:
    """Largest side of each link with all that hangs on it, in the link's frame."""
    poses = link_transforms(robot)
    points: dict[str, list[np.ndarray]] = {link.name: [] for link in robot.links}
    parents = {joint.child: joint.parent for joint in robot.joints}
    for link in robot.links:
        T, corners = poses[link.name], _corners(link)
        at: str | None = link.name
        while at is not None and len(corners):
            points[at].append(corners @ T[:3, :3].T + T[:3, 3])
            at = parents.get(at)
    return {
        name: float(np.ptp(np.concatenate(found), axis=0).max()) if found else 0.0
        for name, found in points.items()
    }


def _corners(link: Link) -> np.ndarray:
    meshes = [visual.mesh for visual in link.visuals]
    if not meshes:
        return np.zeros((0, 3))
    bounds = [np.stack([m.vertices.min(0), m.vertices.max(0)]) for m in meshes]
    return np.concatenate(bounds)
