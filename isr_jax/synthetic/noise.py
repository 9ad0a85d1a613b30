"""The depth camera: what a structured-light sensor makes of true depth."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

from ..config import NoiseModel
from ..types import Camera

NO_NOISE = NoiseModel(
    axial_m=0.0,
    axial_growth_per_m=0.0,
    grazing_m=0.0,
    lateral_px=0.0,
    disparity_step_px=0.0,
    edge_dropout=0.0,
    dropout=0.0,
    grazing_limit=np.pi,
    range_min_m=0.0,
    range_max_m=100.0,
)
"""True depth, to the millimetre of the files."""
_EDGE_RATIO = 0.02
"""A step between neighbours beyond this share of the depth is an edge."""


def axial_sigma_m(
    noise: NoiseModel,
    depth_m: Float[np.ndarray, "*shape"],
    incidence: Float[np.ndarray, "*shape"],
) -> Float[np.ndarray, "*shape"]:
    """Standard deviation of depth, quantisation included, metres.

    sigma_z = a + b (z - 0.4)^2 + c / sqrt(z) theta^2 / (pi/2 - theta)^2,   theta = incidence

    The model that Nguyen, Izadi and Lovell (3DIMPVT 2012) fitted to a Kinect, in metres. They
    give the last term for theta above 60 degrees; it is small below.
    """
    z = np.maximum(depth_m, 0.1)
    angle = np.minimum(incidence, 1.5)
    grazing = noise.grazing_m / np.sqrt(z) * (angle / (np.pi / 2 - angle)) ** 2
    return noise.axial_m + noise.axial_growth_per_m * (z - 0.4) ** 2 + grazing


def quantum_m(
    noise: NoiseModel, camera: Camera, depth_m: Float[np.ndarray, "*shape"]
) -> Float[np.ndarray, "*shape"]:
    """Step of the depth between neighbouring disparities: z^2 q / (f b), metres."""
    focal_baseline = camera.fx * noise.baseline_m
    if focal_baseline * noise.disparity_step_px == 0:
        return np.zeros_like(depth_m)
    return depth_m**2 * np.float32(noise.disparity_step_px / focal_baseline)


def sensor_depth(
    depth_m: Float[np.ndarray, "height width"],
    incidence: Float[np.ndarray, "height width"],
    camera: Camera,
    noise: NoiseModel,
    rng: np.random.Generator,
) -> Float[np.ndarray, "height width"]:
    """What the sensor returns for true depth; 0 = no return.

    Edges wander sideways by a Gaussian of ``lateral_px`` pixels; depth gets Gaussian noise of
    `axial_sigma_m` less what the rounding of the disparity to steps of q adds by itself
    (uniform: quantum / sqrt 12); pixels at edges, at grazing angles and out of range are lost.

    Args:
        depth_m: Along the optical axis; 0 = nothing there.
        incidence: Angle between ray and surface normal, radians.
        camera: Its focal length turns disparities into depth.
        noise: The sensor.
        rng: Source of all randomness.
    """
    edges = depth_edges(depth_m)
    moved, angle = _wander(depth_m, incidence, edges, noise, rng)
    step = quantum_m(noise, camera, moved)
    sigma = axial_sigma_m(noise, moved, angle)
    spread = np.sqrt(np.maximum(sigma**2 - step**2 / 12, 0)).astype(np.float32)
    noisy = moved + spread * rng.standard_normal(moved.shape, np.float32)
    noisy = _quantised(noisy, noise, camera)
    lost = rng.random(moved.shape, np.float32)
    keep = lost >= np.where(edges, max(noise.edge_dropout, noise.dropout), noise.dropout)
    keep &= (moved > 0) & (angle < noise.grazing_limit)
    keep &= (noisy >= noise.range_min_m) & (noisy <= noise.range_max_m)
    return np.where(keep, noisy, np.float32(0)).astype(np.float32)


def depth_edges(depth_m: Float[np.ndarray, "height width"]) -> Bool[np.ndarray, "height width"]:
    """Pixels within one pixel of a step in depth."""
    edges = np.zeros(depth_m.shape, bool)
    limit = np.float32(_EDGE_RATIO)
    for axis in (0, 1):
        near, far = _neighbours(depth_m, axis)
        step = np.abs(near - far) > limit * np.maximum(np.minimum(near, far), 0.1)
        # A slanted plane steps evenly; only a jump of the step itself is an edge.
        change = np.abs(np.diff(depth_m, 2, axis))
        bend = np.zeros(depth_m.shape, bool)
        inner = [slice(None), slice(None)]
        inner[axis] = slice(1, -1)
        bend[tuple(inner)] = change > limit * np.maximum(depth_m[tuple(inner)], 0.1)
        first, second = _neighbours(edges, axis)
        at_first, at_second = _neighbours(bend, axis)
        hit = step & (at_first | at_second)
        first |= hit
        second |= hit
    return edges


def _neighbours(image: np.ndarray, axis: int) -> tuple[np.ndarray, np.ndarray]:
    """Two views of an image: each pixel but the last, and its successor along an axis."""
    return (image[:-1], image[1:]) if axis == 0 else (image[:, :-1], image[:, 1:])


def _wander(depth_m, incidence, edges, noise, rng):
    """Depth and angle with the pixels at edges taken from a place nearby."""
    if noise.lateral_px == 0:
        return depth_m, incidence
    rows, columns = np.nonzero(edges)
    shift = np.rint(noise.lateral_px * rng.standard_normal((2, len(rows)))).astype(np.int64)
    height, width = depth_m.shape
    source = (np.clip(rows + shift[0], 0, height - 1), np.clip(columns + shift[1], 0, width - 1))
    moved, angle = depth_m.copy(), incidence.copy()
    moved[rows, columns], angle[rows, columns] = depth_m[source], incidence[source]
    return moved, angle


def _quantised(depth_m: np.ndarray, noise: NoiseModel, camera: Camera) -> np.ndarray:
    focal_baseline = camera.fx * noise.baseline_m
    if focal_baseline * noise.disparity_step_px == 0:
        return depth_m
    disparity = focal_baseline / np.maximum(depth_m, 0.05)
    steps = np.maximum(np.rint(disparity / noise.disparity_step_px), 1.0)
    return np.where(depth_m > 0.05, focal_baseline / (steps * noise.disparity_step_px), 0)
