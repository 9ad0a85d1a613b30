"""Joints as robot files state them, made sound: limits that exist, contain zero, and an axis."""

from __future__ import annotations

import dataclasses

import numpy as np

from ....robot_model import Joint, joint_motion

_FULL_TURN = 2 * np.pi
_LONGEST_SLIDES = 10.0
"""A slide range beyond so many sizes of what slides is no limit."""


def sound_joint(joint: Joint, stated: bool, child_size: float, notes: list[str]) -> Joint:
    """The joint with a unit axis and limits around zero; ``notes`` says what was repaired.

    Args:
        joint: Kind, frame, axis and limits as in the file.
        stated: The file states limits.
        child_size: Largest side of what moves, in the file's unit.
        notes: Gets a line for each repair.
    """
    joint = _with_axis(joint, notes)
    if joint.kind in ("fixed", "continuous"):
        return dataclasses.replace(joint, lower=0.0, upper=0.0)
    lower, upper = joint.lower, joint.upper
    if not (np.isfinite(lower) and np.isfinite(upper)):
        stated = False
    if stated and lower > upper:
        notes.append(f"joint {joint.name}: limits {lower:g} to {upper:g} exchanged")
        lower, upper = upper, lower
    if stated and joint.kind == "prismatic":
        stated = upper - lower <= _LONGEST_SLIDES * child_size or child_size == 0
    if not stated:
        lower, upper = _guessed(joint, child_size, notes)
    if joint.kind == "revolute" and upper - lower > 2 * _FULL_TURN:
        notes.append(f"joint {joint.name}: limits of several turns, made continuous")
        return dataclasses.replace(joint, kind="continuous", lower=0.0, upper=0.0)
    if upper - lower <= 0:
        notes.append(f"joint {joint.name}: no travel between its limits, fixed")
        still = joint.T_parent_child @ joint_motion(joint, lower)
        return dataclasses.replace(joint, kind="fixed", T_parent_child=still, lower=0.0, upper=0.0)
    return _around_zero(dataclasses.replace(joint, lower=lower, upper=upper), notes)


def _with_axis(joint: Joint, notes: list[str]) -> Joint:
    axis = np.asarray(joint.axis, np.float64)
    length = np.linalg.norm(axis)
    if np.isfinite(length) and length > 1e-9:
        return dataclasses.replace(joint, axis=axis / length)
    if joint.kind != "fixed":
        notes.append(f"joint {joint.name}: its axis has no direction, fixed")
    return dataclasses.replace(joint, kind="fixed", axis=np.array([1.0, 0.0, 0.0]))


def _guessed(joint: Joint, child_size: float, notes: list[str]) -> tuple[float, float]:
    if joint.kind == "revolute":
        notes.append(f"joint {joint.name}: no limits stated, half a turn either way guessed")
        return -np.pi, np.pi
    notes.append(f"joint {joint.name}: no limits stated, the length of what slides guessed")
    return 0.0, child_size or 1.0


def _around_zero(joint: Joint, notes: list[str]) -> Joint:
    """Where zero is no position of the joint, the nearest limit becomes zero."""
    shift = min(max(0.0, joint.lower), joint.upper)
    if shift == 0.0:
        return joint
    notes.append(f"joint {joint.name}: zero lies outside its limits, moved to {shift:g}")
    return dataclasses.replace(
        joint,
        T_parent_child=np.asarray(joint.T_parent_child) @ joint_motion(joint, shift),
        lower=joint.lower - shift,
        upper=joint.upper - shift,
    )
