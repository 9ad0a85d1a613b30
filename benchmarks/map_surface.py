"""How fast the surface comes out of the map, beside Open3D's and scikit-image's marching cubes."""

from __future__ import annotations

import time
from collections.abc import Callable

import jax
import numpy as np

from isr_jax.config import InputSettings, MappingSettings
from isr_jax.mapping import PanopticMapper
from isr_jax.mapping.pool import BLOCK_SIDE, sdf_m, weight

from .figures import Figure, seconds_each
from .filmed import Filmed
from .open3d_peer import BLOCK_SIDES, Open3dMap, is_installed

_REPEATS = 3


def surface_figures(film: Filmed, settings: MappingSettings) -> list[Figure]:
    """All of the surface, the surface after one more frame, and the peers' of the same frames."""
    _mapped(film, settings).surface()  # compiles
    mapper = _mapped(film, settings)
    whole_s = _seconds(mapper.surface)
    mapper.integrate(*film.frames[0])
    again_s = _seconds(mapper.surface)
    seconds = {"ours, all of it": whole_s, "ours, after one more frame": again_s}
    if is_installed():
        for side in BLOCK_SIDES:
            peer = _open3d(film, settings, side)
            mesh = lambda peer=peer: peer.mesh(settings.mesh_min_weight)  # noqa: E731
            seconds[f"Open3D, {side}^3 blocks"] = seconds_each(mesh, _REPEATS)[0]
    if is_installed("skimage"):
        seconds["scikit-image, dense"] = seconds_each(_dense(mapper), _REPEATS)[0]
    figures = [Figure(name, 1000 * value, "ms", "lower") for name, value in seconds.items()]
    vertices = len(mapper.surface().mesh.vertices)
    return [*figures, Figure("ours", vertices, "vertices", "higher")]


def _seconds(work: Callable[[], object]) -> float:
    start = time.perf_counter()
    work()
    return time.perf_counter() - start


def _mapped(film: Filmed, settings: MappingSettings) -> PanopticMapper:
    mapper = PanopticMapper(film.sequence.camera, settings)
    for frame, segments in film.frames:
        mapper.integrate(frame, segments)
    jax.block_until_ready(mapper.pool)
    return mapper


def _open3d(film: Filmed, settings: MappingSettings, side: int) -> Open3dMap:
    lengths = (settings.voxel_size_m, settings.truncation_voxels, InputSettings().depth_max_m)
    peer = Open3dMap(film.sequence.camera, side, *lengths)
    for frame, _ in film.frames:
        peer.integrate(peer.prepared(frame))
    return peer


def _dense(mapper: PanopticMapper) -> Callable[[], object]:
    """scikit-image's marching cubes over the map's bounds as one dense grid, made beforehand."""
    from skimage.measure import marching_cubes

    coords = mapper.blocks.coords[: mapper.blocks.used]
    place = (coords - coords.min(0)) * BLOCK_SIDE
    distance, seen = (np.zeros(place.max(0) + BLOCK_SIDE, t) for t in (np.float32, bool))
    rows = np.arange(mapper.blocks.used)
    cubes = (-1, BLOCK_SIDE, BLOCK_SIDE, BLOCK_SIDE)
    values = np.asarray(sdf_m(mapper.pool, rows)).reshape(cubes)
    observed = np.asarray(weight(mapper.pool, rows)).reshape(cubes) > 0
    for at, value, mask in zip(place, values, observed, strict=True):
        cube = tuple(slice(low, low + BLOCK_SIDE) for low in at)
        distance[cube], seen[cube] = value, mask
    return lambda: marching_cubes(distance, 0.0, mask=seen)
