"""How fast frames become a voxel map, beside Open3D on the same frames and beside the bound."""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial

import numpy as np

from isr_jax.config import InputSettings, MappingSettings, preset, with_overrides
from isr_jax.mapping import PanopticMapper
from isr_jax.runtime.caches import enable_compilation_cache

from .bandwidth import copy_bytes_per_s
from .figures import Figure, Stopwatch, note, show
from .filmed import Filmed, SegmentedFrames, filmed_room, integrated, without_segments
from .live_loop import kitchen_figures, live_figures
from .map_growth import growth_figures
from .map_memory import changed_blocks, memory_figures, traffic_figures
from .map_surface import surface_figures
from .open3d_peer import BLOCK_SIDES, HOW_TO_GET, Open3dMap, is_installed

_RATIO, _LABEL_PERCENT = 2.0, 30.0
"""The promises: times faster than Open3D's geometry, and what labels add at most."""
_FINE_M = 0.02
"""They are made for voxels up to this size."""
_Ready = Callable[[], Callable[[], object]]
"""Makes an empty map; what it returns integrates the film into it."""
_Peer = Callable[[], Open3dMap]
_OURS, _BARE = "ours", "ours, nothing to label"
_PASSES = 5
"""Films that each integrates, each time from nothing."""
_REST_S = 0.3
"""Before each turn: the threads of the one before may wait for work in a busy loop."""


def mapping(
    voxels_m: tuple[float, ...] = (0.01, 0.02, 0.05),
    frames: int = 64,
    variants: tuple[str, ...] = ("mapping.carve=false", "mapping.frames_per_step=4"),
    surface: bool = False,
    live: bool = True,
    long: int = 0,
    long_voxel_m: float = 0.05,
    width: int = 640,
    height: int = 480,
    seed: int = 7,
) -> None:
    """Time the mapping of a film of a furnished room, in turns with Open3D.

    Ours does everything: marks and allocates blocks, updates geometry and colour, frees what is
    seen through, votes, counts labels, decides on classes and instances. Open3D's VoxelBlockGrid
    finds and allocates blocks and updates geometry alone; its better block size is the peer.
    Kernels are compiled before the clock starts. Each maps the whole film from nothing, in turn,
    several times; figures are means over the frames, growth of the maps included, of the median
    pass.
    The promises are about wall times: run this on a machine that does nothing else. Core times (of
    all threads) hardly feel what else runs.

    Args:
        voxels_m: Sizes of voxels, metres.
        frames: Of the film. Merged labels get their new numbers every 64 frames: in the last one.
        variants: Settings that ours is timed with as well, each by itself.
        surface: Time the extraction of the surface too, beside Open3D's and scikit-image's.
        live: Time the parts of the live loop at 2 cm, and the whole; also on a real kitchen with
            YOLOX and DeepLab, where $ISR_SHARED_DATA has them.
        long: Integrate so many frames of room after room; compare early and late ones. 0 = not.
        long_voxel_m: Size of the voxels there, metres.
        width: Of the images, pixels.
        height: Of the images, pixels.
        seed: Of the room.
    """
    enable_compilation_cache()
    if not is_installed():
        note(HOW_TO_GET)
    bytes_per_s = copy_bytes_per_s()
    with filmed_room(seed, frames, width, height) as film:
        camera = film.sequence.camera
        size = f"{len(film.frames)} frames of {camera.width} x {camera.height}"
        for voxel_m in voxels_m:
            title = f"{100 * voxel_m:g} cm voxels, {size}"
            base = _settings(voxel_m)
            others = {variant: _settings(voxel_m, variant) for variant in variants}
            show(f"mapping, {title}", _mapping_figures(film, base, others, bytes_per_s))
            if surface:
                show(f"surface, {title}", surface_figures(film, base))
        if live:
            figures = live_figures(film.sequence, film.segmenter, len(film.frames))
            show(f"live loop, 2 cm voxels, {size}", figures)
        if long:
            figures = growth_figures(film, _settings(long_voxel_m), long)
            show(f"growth, {100 * long_voxel_m:g} cm voxels, {long} frames", figures)
    kitchen = kitchen_figures(frames) if live else []
    if kitchen:
        show("live loop, 2 cm voxels, a kitchen with YOLOX and DeepLab", kitchen)


def _settings(voxel_m: float, *overrides: str) -> MappingSettings:
    changes = [f"mapping.voxel_size_m={voxel_m}", *overrides]
    return with_overrides(preset("default"), changes).mapping


def _mapping_figures(
    film: Filmed,
    settings: MappingSettings,
    variants: dict[str, MappingSettings],
    bytes_per_s: float,
) -> list[Figure]:
    bare = without_segments(film.frames)
    work = {_OURS: _ours(film, settings, film.frames), _BARE: _ours(film, settings, bare)}
    for variant, other in variants.items():
        work[f"ours, {variant}"] = _ours(film, other, film.frames)
        changed_blocks(film.frames, _mapper(film, other))  # compiles all that the film needs
    mapper, peers = _mapper(film, settings), _peers(film, settings)
    blocks = changed_blocks(film.frames, mapper)
    work |= peers
    watch = _in_turn(work, len(film.frames))
    figures, wall_ms = [], watch.ms(_OURS)
    for core in (False, True):
        ms = {name: watch.ms(name, core=core) for name in work}
        unit = "core ms per frame" if core else "ms per frame"
        figures += [Figure(name, value, unit, "lower") for name, value in ms.items()]
        labels_ms = watch.extra_ms(_OURS, _BARE, core=core)
        figures += _ratios(ms, labels_ms, list(peers), settings, core=core)
    figures += memory_figures(mapper, {name: ready()() for name, ready in peers.items()})
    return figures + traffic_figures(mapper, float(np.median(blocks)), bytes_per_s, wall_ms)


def _ratios(
    ms: dict[str, float],
    labels_ms: float,
    peers: list[str],
    settings: MappingSettings,
    *,
    core: bool,
) -> list[Figure]:
    """What labels add, and how much longer the better peer takes; promised of wall times."""
    unit = " of core time" if core else ""
    share = 100 * labels_ms / ms[_BARE]
    figures = [Figure("labels add", share, "%" + unit, "lower", None if core else _LABEL_PERCENT)]
    if peers:
        ratio = min(ms[name] for name in peers) / ms[_OURS]
        fine = settings.voxel_size_m <= _FINE_M and not core
        bound = _RATIO if fine else None
        figures.append(Figure("best Open3D / ours", ratio, "x" + unit, "higher", bound))
    return figures


def _in_turn(work: dict[str, _Ready], frames: int) -> Stopwatch:
    """The film by each, again and again, in an order that turns; empty maps are made before."""
    watch, names = Stopwatch(), list(work)
    for turn in range(_PASSES):
        for name in names[turn:] + names[:turn]:
            map_film = work[name]()
            time.sleep(_REST_S)
            watch.time(name, map_film, items=frames)
    return watch


def _mapper(film: Filmed, settings: MappingSettings) -> PanopticMapper:
    return PanopticMapper(film.sequence.camera, settings)


def _ours(film: Filmed, settings: MappingSettings, frames: SegmentedFrames) -> _Ready:
    return lambda: partial(integrated, _mapper(film, settings), frames)


def _peers(film: Filmed, settings: MappingSettings) -> dict[str, Callable[[], _Peer]]:
    if not is_installed():
        return {}
    far_m = InputSettings().depth_max_m
    lengths = (settings.voxel_size_m, settings.truncation_voxels, far_m)

    def ready(side: int) -> _Peer:
        peer = Open3dMap(film.sequence.camera, side, *lengths)
        prepared = [peer.prepared(frame) for frame, _ in film.frames]

        def map_film() -> Open3dMap:
            for one in prepared:
                peer.integrate(one)
            return peer

        return map_film

    return {f"Open3D, {side}^3 blocks": partial(ready, side) for side in BLOCK_SIDES}
