"""The depth camera: what a structured-light sensor makes of true depth."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float
from scipy import ndimage

from ...config import NoiseModel
from ...types import Camera
from .projector import unlit

NO_NOISE = NoiseModel(
    axial_m=0.0,
    axial_growth_per_m=0.0,
    grazing_m=0.0,
    lateral_px=0.0,
    lateral_growth_px=0.0,
    disparity_step_px=0.0,
    projector_shadow=False,
    edge_dropout=0.0,
    dropout=0.0,
    least_return=0.0,
    grazing_limit=np.pi,
    range_min_m=0.0,
    range_max_m=100.0,
)
"""True depth, to the millimetre of the files."""
_EDGE_RATIO = 0.02
"""A step between neighbours beyond this share of the depth is an edge."""
_FLATTEST_RAD = 1.5
"""Angles above this count as this one: the published terms have a pole at pi/2."""


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
    z = np.maximum(depth_m, np.float32(0.1))
    grazing = _towards_grazing(incidence)
    grazing = np.float32(noise.grazing_m) / np.sqrt(z) * grazing * grazing
    off = z - np.float32(0.4)
    return np.float32(noise.axial_m) + np.float32(noise.axial_growth_per_m) * off * off + grazing


def lateral_sigma_px(
    noise: NoiseModel, incidence: Float[np.ndarray, "*shape"]
) -> Float[np.ndarray, "*shape"]:
    """Standard deviation of where an edge is seen, pixels.

    sigma_L = a + b theta / (pi/2 - theta),   a = 0.8, b = 0.035

    The lateral part of Nguyen, Izadi and Lovell (3DIMPVT 2012); times z / f it is in metres.
    """
    growth = np.float32(noise.lateral_growth_px) * _towards_grazing(incidence)
    return np.float32(noise.lateral_px) + growth


def _towards_grazing(incidence: np.ndarray) -> np.ndarray:
    angle = np.minimum(incidence, np.float32(_FLATTEST_RAD))
    return angle / (np.float32(np.pi / 2) - angle)


def quantum_m(
    noise: NoiseModel, camera: Camera, depth_m: Float[np.ndarray, "*shape"]
) -> Float[np.ndarray, "*shape"]:
    """Step of the depth between neighbouring disparities: z^2 q / (f b), metres.

    With q = 1/8 px, b = 75 mm and f = 585 px it is 2.85e-3 z^2: Khoshelham and Oude Elberink
    (Sensors 12, 2012) measured 7 cm at 5 m, which is 2.8e-3 z^2.
    """
    focal_baseline = camera.fx * noise.baseline_m
    if focal_baseline * noise.disparity_step_px == 0:
        return np.zeros_like(depth_m)
    return depth_m * depth_m * np.float32(noise.disparity_step_px / focal_baseline)


def sensor_depth(
    depth_m: Float[np.ndarray, "height width"],
    incidence: Float[np.ndarray, "height width"],
    camera: Camera,
    noise: NoiseModel,
    rng: np.random.Generator,
    *,
    albedo: Float[np.ndarray, "height width"] | None = None,
) -> Float[np.ndarray, "height width"]:
    """What the sensor returns for true depth; 0 = no return.

    Edges wander sideways by a Gaussian of `lateral_sigma_px`; depth gets Gaussian noise of
    `axial_sigma_m` less what the rounding of the disparity to steps of q adds by itself
    (uniform: quantum / sqrt 12), part of it in common with the neighbours (`correlated`). Lost
    are a share of the pixels at edges (a window that straddles a step matches neither side; the
    share is a choice of ours), what the projector does not light (`projector.unlit`), what
    returns too little (`too_dim`), surfaces seen too flat, and what is out of range.

    Args:
        depth_m: Along the optical axis; 0 = nothing there.
        incidence: Angle between ray and surface normal, radians.
        camera: Its focal length turns disparities into depth.
        noise: The sensor.
        rng: Source of all randomness.
        albedo: In [0, 1]; None: nothing is too dark.
    """
    edges = depth_edges(depth_m)
    moved, angle = _wander(depth_m, incidence, edges, noise, rng)
    sigma = axial_sigma_m(noise, moved, angle)
    step = quantum_m(noise, camera, moved)
    spread = np.sqrt(np.maximum(sigma * sigma - step * step * np.float32(1 / 12), 0))
    noisy = moved + spread * _unit_noise(moved.shape, noise, rng)
    noisy = _quantised(noisy, noise, camera)
    draw = rng.random(moved.shape, np.float32)
    keep = draw >= np.where(
        edges, np.float32(max(noise.edge_dropout, noise.dropout)), noise.dropout
    )
    keep &= (moved > 0) & (angle < noise.grazing_limit)
    keep &= (noisy >= noise.range_min_m) & (noisy <= noise.range_max_m)
    if noise.projector_shadow:
        keep &= ~unlit(depth_m, camera.fx * noise.baseline_m)
    if noise.least_return > 0 and albedo is not None:
        keep &= ~too_dim(noise, moved, angle, albedo, rng.random(moved.shape, np.float32))
    return np.where(keep, noisy, np.float32(0)).astype(np.float32)


def too_dim(
    noise: NoiseModel,
    depth_m: Float[np.ndarray, "*shape"],
    incidence: Float[np.ndarray, "*shape"],
    albedo: Float[np.ndarray, "*shape"],
    draw: Float[np.ndarray, "*shape"],
) -> Bool[np.ndarray, "*shape"]:
    """Whether the pattern comes back too faint: with probability 2 - s / s_0, within [0, 1].

    s = albedo cos(theta) / z^2 is what a Lambertian surface returns of a lamp at the camera;
    s_0 = ``noise.least_return``. Gloss is not modelled.

    Args:
        noise: The sensor.
        depth_m: Along the optical axis.
        incidence: Angle between ray and surface normal, radians.
        albedo: In [0, 1].
        draw: Uniform in [0, 1).
    """
    least = np.float32(noise.least_return)
    returned = albedo * np.cos(incidence)
    return returned < least * (2 - draw) * depth_m * depth_m


def correlated(
    shape: tuple[int, int], window_px: int, rng: np.random.Generator
) -> Float[np.ndarray, "height width"]:
    """Gaussian noise of unit variance that neighbours have in common.

    The mean of white noise over a window, scaled: two pixels (i, j) apart correlate by
    (1 - |i|/w)(1 - |j|/w), the overlap of their windows. A structured-light camera matches
    windows, so disparities err together over one (Barron and Malik, CVPR 2013, and Handa et al.,
    ICRA 2014, shift image points locally before they round the disparity; Bohg et al., ICRA 2014,
    match windows); a Kinect's is 9 x 9 (Khoshelham and Oude Elberink 2012).
    """
    around = 2 * (window_px // 2)
    white = rng.standard_normal((shape[0] + around, shape[1] + around), np.float32)
    mean = ndimage.uniform_filter(white, window_px, mode="constant")
    half = window_px // 2
    return mean[half : half + shape[0], half : half + shape[1]] * np.float32(window_px)


def _unit_noise(shape, noise, rng):
    """Unit variance, ``correlated_share`` of it in common with the neighbours."""
    own = rng.standard_normal(shape, np.float32)
    share = noise.correlated_share
    if share == 0 or noise.correlation_px == 1:
        return own
    common = correlated(shape, noise.correlation_px, rng)
    return np.float32(np.sqrt(1 - share)) * own + np.float32(np.sqrt(share)) * common


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
    sigma = lateral_sigma_px(noise, incidence[rows, columns])
    shift = np.rint(sigma * rng.standard_normal((2, len(rows)))).astype(np.int64)
    height, width = depth_m.shape
    source = (np.clip(rows + shift[0], 0, height - 1), np.clip(columns + shift[1], 0, width - 1))
    moved, angle = depth_m.copy(), incidence.copy()
    moved[rows, columns], angle[rows, columns] = depth_m[source], incidence[source]
    return moved, angle


def _quantised(depth_m: np.ndarray, noise: NoiseModel, camera: Camera) -> np.ndarray:
    focal_baseline = camera.fx * noise.baseline_m
    if focal_baseline * noise.disparity_step_px == 0:
        return depth_m
    per_step = np.float32(focal_baseline / noise.disparity_step_px)
    steps = np.maximum(np.rint(per_step / np.maximum(depth_m, np.float32(0.05))), 1)
    return np.where(depth_m > 0.05, per_step / steps, np.float32(0))
