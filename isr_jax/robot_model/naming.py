"""Names of a model's links and joints inside a scene: the same in MJCF, URDF and scene.json."""

from __future__ import annotations

import dataclasses

from .model import RobotModel


def named_in_scene(model: RobotModel, name: str) -> RobotModel:
    """The model as entity ``name``: its root link takes that name, the rest are prefixed with it.

    ``door`` of ``fridge_2`` becomes ``fridge_2_door``; joints likewise.
    """
    root = model.links[0].name
    links = {
        link.name: name if link.name == root else f"{name}_{link.name}" for link in model.links
    }
    return RobotModel(
        name=name,
        links=tuple(dataclasses.replace(link, name=links[link.name]) for link in model.links),
        joints=tuple(
            dataclasses.replace(
                joint,
                name=f"{name}_{joint.name}",
                parent=links[joint.parent],
                child=links[joint.child],
            )
            for joint in model.joints
        ),
    )


def weld_groups(model: RobotModel) -> dict[str, int]:
    """Number of the rigid group (links joined by fixed joints) of each link."""
    group = {model.links[0].name: 0}
    pending = list(model.joints)
    while pending:
        joint = next(j for j in pending if j.parent in group)
        pending.remove(joint)
        fixed = joint.kind == "fixed"
        group[joint.child] = group[joint.parent] if fixed else max(group.values()) + 1
    return group


def excluded_pairs(model: RobotModel) -> tuple[tuple[str, str], ...]:
    """Link pairs across a joint, which must not collide: they touch at the hinge by design."""
    group = weld_groups(model)
    across = {(group[j.parent], group[j.child]) for j in model.moving_joints}
    names = [link.name for link in model.links]
    return tuple(
        (a, b)
        for i, a in enumerate(names)
        for b in names[i + 1 :]
        if (group[a], group[b]) in across or (group[b], group[a]) in across
    )
