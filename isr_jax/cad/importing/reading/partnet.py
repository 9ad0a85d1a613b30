"""PartNet-Mobility: one folder per model: ``mobility.urdf``, ``semantics.txt``, ``meta.json``.

Models are scaled to a unit sphere, so they have no unit. The URDF's root stands z up and faces
-x. ``semantics.txt`` names each link: ``link_0 hinge door``. Visuals called ``handle-<n>`` are
where hands go.
"""

from __future__ import annotations

import dataclasses
import json
import posixpath

import numpy as np

from ....errors import LibraryError
from ....robot_model import RobotModel
from ..found import FoundModel, Vector
from ..names import slug
from .files import Files
from .limits import ReadLimits
from .urdf_format import read_urdf_model

URDF = "mobility.urdf"
SEMANTICS = "semantics.txt"
_META = "meta.json"
_LICENCE = "PartNet-Mobility terms of use: research and education, not to be passed on"
_CATEGORY_TAGS = {"StorageFurniture": "storage furniture cabinet", "TrashCan": "trash bin"}


def read_partnet(files: Files, name: str, limits: ReadLimits) -> FoundModel:
    """The model of one folder, ``name`` its URDF; raises `LibraryError`."""
    folder = posixpath.dirname(name)
    found = read_urdf_model(files, name, limits)
    notes = list(found.notes)
    category = _category(files, folder, notes)
    parts = _semantics(files, folder, found.robot, notes)
    number = posixpath.basename(folder or files.label)
    tags = (*([category, _CATEGORY_TAGS.get(category, "")] if category else []), *parts.values())
    return dataclasses.replace(
        found,
        name=f"{slug(category or 'partnet')}_{number}",
        unit_m=None,
        front=np.array([-1.0, 0.0, 0.0]),
        tags=tuple(dict.fromkeys(tag for tag in tags if tag)),
        licence=_LICENCE,
        creator="PartNet-Mobility",
        handles=_handles(found.robot),
        notes=tuple(notes),
    )


def _category(files: Files, folder: str, notes: list[str]) -> str:
    name = posixpath.join(folder, _META)
    if not files.has(name):
        notes.append(f"{_META} is missing: no category")
        return ""
    try:
        meta = json.loads(files.read(name))
        return str(meta["model_cat"])
    except (LibraryError, ValueError, KeyError, TypeError, RecursionError):
        notes.append(f"{_META} names no model_cat: no category")
        return ""


def _semantics(files: Files, folder: str, robot: RobotModel, notes: list[str]) -> dict[str, str]:
    """What each link is called, of the links that there are."""
    text = files.read(posixpath.join(folder, SEMANTICS)).decode("utf-8", "replace")
    rows = [line.split() for line in text.splitlines() if line.strip()]
    named = {row[0]: row[2] for row in rows if len(row) == 3}
    known = {link.name for link in robot.links}
    strange = [row for row in rows if len(row) != 3 or row[0] not in known]
    if strange:
        notes.append(f"{len(strange)} lines of {SEMANTICS} name no link")
    return {link: part for link, part in named.items() if link in known}


def _handles(robot: RobotModel) -> dict[str, Vector]:
    """Middle of the handles of each moving joint's child, in the child's frame."""
    found: dict[str, Vector] = {}
    for joint in robot.moving_joints:
        visuals = [v for v in robot.link(joint.child).visuals if v.name.startswith("handle")]
        if visuals:
            points = np.concatenate([v.mesh.vertices for v in visuals])
            found[joint.name] = (points.min(0) + points.max(0)) / 2
    return found
