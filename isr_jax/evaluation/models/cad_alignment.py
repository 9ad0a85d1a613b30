"""CAD alignment accuracy: centre within 20 cm, rotation within 20 degrees, size within 20 %.

The limits are those of Scan2CAD (Avetisyan et al. 2019). Retrieval may choose another model of the
class, so sizes are compared, not scales, and each axis by itself: errors of two axes must not
cancel.
"""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Float

ROUND = 0
"""Order of symmetry of a model that looks the same at any yaw."""


@dataclasses.dataclass(frozen=True)
class AlignmentLimits:
    """How far a model may be off and still count."""

    center_m: float = 0.2
    rotation_rad: float = float(np.deg2rad(20.0))
    size_ratio: float = 0.2


@dataclasses.dataclass(frozen=True, eq=False)
class CadPose:
    """Where a model stands."""

    id: str
    rotation: Float[np.ndarray, "3 3"]
    """Model axes in the world."""
    center: Float[np.ndarray, "3"]
    size: Float[np.ndarray, "3"]
    """Scaled extent along the model's own axes, metres."""


def rotation_error_rad(
    truth: Float[np.ndarray, "3 3"], predicted: Float[np.ndarray, "3 3"], symmetry: int
) -> float:
    """Least angle between the rotations over turns about the model's z that leave it the same.

    Args:
        truth: Model axes in the world.
        predicted: Likewise.
        symmetry: Order about z: 1 = none, 2, 4, ...; 0 = round.
    """
    if symmetry == ROUND:
        return _angle(float(truth[:, 2] @ predicted[:, 2]))
    errors = []
    for turn in 2 * np.pi * np.arange(symmetry) / symmetry:
        c, s = np.cos(turn), np.sin(turn)
        same = truth @ np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        errors.append(_angle((float(np.sum(same * predicted)) - 1) / 2))
    return min(errors)


def _angle(cosine: float) -> float:
    return float(np.arccos(np.clip(cosine, -1.0, 1.0)))


def size_error(truth: CadPose, predicted: CadPose, symmetry: int) -> float:
    """Mean over the axes of |s' / s - 1|; a round or square model may swap x and y."""
    errors = [float(np.abs(predicted.size / truth.size - 1).mean())]
    if symmetry in (ROUND, 4):
        errors.append(float(np.abs(predicted.size[[1, 0, 2]] / truth.size - 1).mean()))
    return min(errors)


@dataclasses.dataclass(frozen=True)
class CadErrors:
    """How far one model is off."""

    center_m: float
    rotation_rad: float
    size_ratio: float
    aligned: bool
    """Within all three limits."""


def score_cads(
    truth: CadPose, predicted: CadPose, symmetry: int, limits: AlignmentLimits
) -> CadErrors:
    """Compare one placed model with the true one."""
    center_m = float(np.linalg.norm(truth.center - predicted.center))
    rotation_rad = rotation_error_rad(truth.rotation, predicted.rotation, symmetry)
    ratio = size_error(truth, predicted, symmetry)
    aligned = (
        center_m <= limits.center_m
        and rotation_rad <= limits.rotation_rad
        and ratio <= limits.size_ratio
    )
    return CadErrors(center_m, rotation_rad, ratio, aligned)
