"""One model checked: what its numbers say, and how it behaves in MuJoCo."""

from __future__ import annotations

import json
import time
from pathlib import Path
from typing import Any

import numpy as np

from ...errors import IsrError
from ...library import CadModel, Handle
from ...robot_model import Joint, RobotModel
from ..model_files import model_files
from ..records import check_links, check_record
from .hand import FLOOR, Travel
from .physics import STANDING_MOUNTS, ModelPhysics, Overlap
from .planes import plane_faults
from .report import CHECKS, Fault, ModelCheck
from .settings import CheckSettings
from .static import (
    hull_faults,
    inertia_faults,
    inertia_problem,
    joint_faults,
    shortened,
)

_STATIC = {
    "hulls": hull_faults,
    "inertia": inertia_faults,
    "joints": joint_faults,
    "planes": plane_faults,
}


def check_model(model: CadModel, settings: CheckSettings | None = None) -> ModelCheck:
    """Check one model: content hash, hulls, inertia, joints, planes, how it stands and opens."""
    began, settings = time.perf_counter(), settings or CheckSettings()
    unreadable = _file_faults(model)
    if unreadable:
        return unread(model.id, unreadable[0])
    faults: list[Fault] = []
    bare = model.collision == "none"
    for check, find in _STATIC.items():
        if not (bare and check == "hulls"):
            faults += [Fault(check, reason) for reason in find(model, settings)]
    skipped, figures = (), {}
    if bare:
        why = "no collision hulls yet: give --hulls vhacd or --hulls coacd"
        skipped = tuple(Fault(check, why) for check in ("hulls", "standing", "opening"))
    elif not _simulable(model):
        why = "needs hulls, and a mass and inertia of every link"
        skipped = tuple(Fault(check, why) for check in ("standing", "opening"))
    else:
        more, figures = _behaviour(model, settings)
        faults = sorted(faults + more, key=lambda fault: CHECKS.index(fault.check))
    seconds = time.perf_counter() - began
    return ModelCheck(model.id, tuple(faults), skipped, seconds=seconds, **figures)


def unread(cad_id: str, problem: str) -> ModelCheck:
    """Of a model whose files cannot be used: nothing else can be checked."""
    why = "its files cannot be used"
    skipped = tuple(Fault(check, why) for check in CHECKS if check != "files")
    return ModelCheck(cad_id, (Fault("files", problem),), skipped)


def _simulable(model: CadModel) -> bool:
    links = model.robot.links
    weighs = all(k.mass_kg > 0 and not inertia_problem(k) for k in links)
    return weighs and any(link.hulls for link in links)


def _file_faults(model: CadModel) -> list[str]:
    """Why the model could not be written and read; its robot is read, if it was not before."""
    try:
        record = json.loads(model_files(model)["model.json"])
        check_record(record, Path(model.id))
        check_links(record, model.robot, Path(model.id))
    except IsrError as error:
        return [error.problem]
    return []


def _behaviour(model: CadModel, settings: CheckSettings) -> tuple[list[Fault], dict[str, Any]]:
    """Faults and figures from simulation."""
    try:
        physics = ModelPhysics(model, settings)
    except ValueError as error:
        return [Fault("standing", f"MuJoCo refuses it: {error}")], {}
    rest = physics.overlaps()
    faults = [
        Fault("hulls", f"{o.link_a} and {o.link_b} overlap by {1000 * o.depth_m:.2f} mm at rest")
        for o in rest
    ]
    drift = physics.standing_drift_m()
    if drift > settings.standing_m:
        how = "standing" if model.mount in STANDING_MOUNTS else "hanging"
        faults.append(Fault("standing", f"moves {1000 * drift:.2f} mm, {how} on its own"))
    opening, figures = _opening(model, physics, rest, settings)
    return faults + opening, {"drift_m": drift, **figures}


def _opening(
    model: CadModel, physics: ModelPhysics, rest: tuple[Overlap, ...], settings: CheckSettings
) -> tuple[list[Fault], dict[str, Any]]:
    """Faults and figures of every joint; pairs that overlap no deeper than at rest are known."""
    at_rest = {(o.link_a, o.link_b): o.depth_m + settings.overlap_m for o in rest}
    reasons, shares, forces = [], [], []
    for joint in model.robot.moving_joints:
        if joint.kind != "continuous" and not joint.lower <= 0 <= joint.upper > joint.lower:
            continue  # said by the check of joints
        overlaps = [
            overlap
            for overlap in physics.overlaps(joint)
            if overlap.depth_m > at_rest.get((overlap.link_a, overlap.link_b), 0.0)
        ]
        reasons += [_overlap_reason(joint, overlap) for overlap in overlaps]
        handle = handle_of(model, joint)
        for held in (True, False):
            travel = physics.travel(handle, joint, held=held)
            shares.append(travel.share)
            forces.append(travel.force_n)
            reasons += _travel_reasons(joint, travel, held, settings, bool(overlaps or rest))
    if not shares:
        return [], {}
    faults = [Fault("opening", reason) for reason in shortened(reasons)]
    return faults, {"share": min(shares), "effort_n": max(forces)}


def _overlap_reason(joint: Joint, overlap: Overlap) -> str:
    where = f"{joint.name} at {_said(joint, overlap.position)}"
    depth = f"{1000 * overlap.depth_m:.2f} mm"
    return f"{where}: {overlap.link_a} and {overlap.link_b} overlap by {depth}"


def _travel_reasons(
    joint: Joint, travel: Travel, held: bool, settings: CheckSettings, overlaps: bool
) -> list[str]:
    who = f"{joint.name}, base {'fixed' if held else 'free'}"
    touching = ""
    if travel.touched:
        touching = f", {travel.touched[0]} touches {travel.touched[1]} at {_said(joint, travel.at)}"
    elif travel.on_floor:
        touching = f", {' and '.join(travel.on_floor)} touches {FLOOR}"
    found = []
    if not travel.share >= settings.travel_share:
        share = f"only {100 * travel.share:.0f} % of its range"
        found.append(f"{who}: {share} under {travel.force_n:.0f} N at its handle{touching}")
    elif travel.depth_m > settings.overlap_m and not overlaps:
        found.append(f"{who}: {1000 * travel.depth_m:.2f} mm deep{touching}")
    if travel.tilt_rad > settings.tilt_rad:
        found.append(f"{who}: it tips by {np.degrees(travel.tilt_rad):.0f} degrees when opened")
    return found


def _said(joint: Joint, position: float) -> str:
    if joint.kind == "prismatic":
        return f"{1000 * position:.0f} mm"
    return f"{np.degrees(position):.0f} degrees"


def handle_of(model: CadModel, joint: Joint) -> Handle:
    """The joint's handle; where none is named, the moved link's point farthest from the joint."""
    for handle in model.handles:
        if handle.joint == joint.name:
            return handle
    return Handle(joint.name, joint.child, farthest_point(model.robot, joint), estimated=True)


def farthest_point(robot: RobotModel, joint: Joint) -> np.ndarray:
    """Vertex [3] of the joint's child farthest from its axis; of a slide, from its origin."""
    link = robot.link(joint.child)
    meshes = link.hulls or tuple(visual.mesh for visual in link.visuals)
    points = np.concatenate([mesh.vertices for mesh in meshes]).astype(np.float64)
    if joint.kind == "prismatic":
        return points.mean(0)
    along = np.asarray(joint.axis, np.float64)
    beside = points - np.outer(points @ along, along)
    return points[int(np.argmax(np.linalg.norm(beside, axis=1)))]
