"""Which views show enough of everything: a greedy cover."""

from __future__ import annotations

import dataclasses

import numpy as np
from jaxtyping import Bool, Float, Int

from ...borders.raycast import RayScene
from ...config import NoiseModel
from ...types import Camera
from .free_space import FreeSpace
from .visibility import Samples, in_image, visible_from

_TARGETS = (0.75, 0.95)
"""Shares of each entity's observable samples that the views are to show, one after the other."""
_HEADINGS = 16
_PITCHES = (-0.62, -0.3, 0.05)
_LEAST_GAIN = 0.08
"""Entities, counted by their newly seen shares, for which one more view is worth it."""
_EYES = 150
"""Places that planning looks from; more are drawn from."""
_PLANNED = 40
"""Samples an entity that planning looks at."""


@dataclasses.dataclass(frozen=True, eq=False)
class Viewpoints:
    """Views in the order in which they were chosen: each shows most that is new."""

    eye: Int[np.ndarray, " views"]
    """Row of the free space's places."""
    heading: Float[np.ndarray, " views"]
    """World frame, radians."""
    pitch: Float[np.ndarray, " views"]
    """Up, radians."""


def choose_viewpoints(
    scene: RayScene,
    samples: Samples,
    space: FreeSpace,
    camera: Camera,
    sensor: NoiseModel,
    *,
    at_most: int,
    rng: np.random.Generator,
) -> Viewpoints:
    """Views that show most of what can be seen of each entity.

    A sample counts 1 over the observable ones of its entity until three quarters of these are
    seen, so that a cup is worth as much as a wall; then nearly all are wanted.

    Args:
        scene: What hides the samples.
        samples: Of what is to be seen.
        space: Where the camera can be.
        camera: Its image bounds what a view shows.
        sensor: Its range and flattest angle do too.
        at_most: Views.
        rng: Turns the fan of headings, and draws places where there are many.
    """
    samples = _thinned(samples)
    places = np.sort(rng.permutation(len(space.eyes))[:_EYES])
    eyes = space.eyes[places]
    from_eye = visible_from(scene, samples, eyes, sensor)
    observable = np.flatnonzero(from_eye.any(0))
    samples, from_eye = samples.subset(observable), from_eye[:, observable]
    heading = rng.uniform(0, 2 * np.pi) + 2 * np.pi * np.arange(_HEADINGS) / _HEADINGS
    heading, pitch = (a.ravel() for a in np.meshgrid(heading, _PITCHES, indexing="ij"))
    shows = _shown(samples, eyes, camera, heading, pitch, from_eye)
    chosen = _greedy(shows, samples.entity, at_most)
    eye, turn = np.divmod(chosen, len(heading))
    return Viewpoints(places[eye], heading[turn], pitch[turn])


def directions(
    heading: Float[np.ndarray, " views"], pitch: Float[np.ndarray, " views"]
) -> Float[np.ndarray, "views 3"]:
    """Unit vectors, world frame."""
    level = np.cos(pitch)
    return np.stack([level * np.cos(heading), level * np.sin(heading), np.sin(pitch)], 1)


def look_along(eye: np.ndarray, forward: np.ndarray) -> Float[np.ndarray, "4 4"]:
    """Pose of an upright camera (x right, y down, z forward) that does not look straight down."""
    right = np.cross(forward, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    T = np.eye(4)
    T[:3, :3] = np.stack([right, np.cross(forward, right), forward], 1)
    T[:3, 3] = eye
    return T


def _thinned(samples: Samples) -> Samples:
    """Every so many-th sample: their order is that of the faces, so all of the surface stays."""
    first = np.searchsorted(samples.entity, samples.entity)
    nth = np.arange(len(samples.entity)) - first
    count = np.bincount(samples.entity)[samples.entity]
    return samples.subset(np.flatnonzero((nth * 2 * _PLANNED) % count < 2 * _PLANNED))


def _shown(
    samples: Samples,
    eyes: np.ndarray,
    camera: Camera,
    heading: np.ndarray,
    pitch: np.ndarray,
    from_eye: np.ndarray,
) -> Bool[np.ndarray, "views samples"]:
    """What each view shows, eye after eye."""
    poses = np.stack([look_along(np.zeros(3), f) for f in directions(heading, pitch)])
    shows = np.zeros((len(eyes), len(heading), len(samples.points)), bool)
    for i, eye in enumerate(eyes):
        rows = np.flatnonzero(from_eye[i])
        poses[:, :3, 3] = eye
        shows[i][:, rows] = in_image(camera, poses, samples.points[rows])
    return shows.reshape(-1, len(samples.points))


def _greedy(shows: np.ndarray, entity: np.ndarray, at_most: int) -> np.ndarray:
    """Rows of ``shows``, the best first, until another is not worth it."""
    total = np.maximum(np.bincount(entity), 1)
    seen = np.zeros(shows.shape[1], bool)
    chosen: list[int] = []
    packed = shows.astype(np.float32)
    for target in _TARGETS:
        while len(chosen) < at_most:
            share = np.bincount(entity[seen], minlength=len(total)) / total
            worth = np.where(seen | (share[entity] >= target), 0, 1 / total[entity])
            gain = packed @ worth.astype(np.float32)
            best = int(np.argmax(gain))
            if gain[best] < _LEAST_GAIN:
                break
            chosen.append(best)
            seen |= shows[best]
    return np.array(chosen or [0], np.int64)
