"""Procedural textures: square tiles of brightness that repeat without a seam."""

from __future__ import annotations

import functools

import numpy as np
from jaxtyping import Float
from scipy import ndimage

TILE_PX = 256
PLAIN, PLANKS, PLASTER, WOOD, WEAVE, SPECKLES, PAINTING = range(7)
TILE_M = (1.0, 1.12, 1.6, 0.8, 0.12, 0.35, 0.7)
"""Side of each tile on a surface, metres."""
_OF_CLASS = {
    "floor": PLANKS,
    "wall": PLASTER,
    "ceiling": PLASTER,
    "rug": WEAVE,
    "curtain": WEAVE,
    "sofa": WEAVE,
    "bed": WEAVE,
    "cushion": WEAVE,
    "chair": WEAVE,
    "bag": WEAVE,
    "picture": PAINTING,
    "counter": SPECKLES,
    "box": SPECKLES,
    "plant": SPECKLES,
    "table": WOOD,
    "desk": WOOD,
    "door": WOOD,
    "stool": WOOD,
    "bench": WOOD,
    "nightstand": WOOD,
    "wardrobe": WOOD,
    "cabinet": WOOD,
    "wall_cabinet": WOOD,
    "bookshelf": WOOD,
    "drawer_unit": WOOD,
}
_PLANKS_ACROSS = 8
_JOINT_PX = 1


def pattern_of(class_name: str) -> int:
    """Row of `tiles` for a class; `PLAIN` for what is smooth."""
    return _OF_CLASS.get(class_name, PLAIN)


@functools.cache
def tiles() -> Float[np.ndarray, "patterns side side"]:
    """Factors on the albedo, mean 1, always the same."""
    rng = np.random.default_rng(0)
    made = [
        np.ones((TILE_PX, TILE_PX)),
        _planks(rng),
        1 + 0.03 * _blotches(rng, 24.0, 24.0) + 0.025 * _blotches(rng, 1.0, 1.0),
        _wood(rng),
        _weave(rng),
        1 + 0.05 * _blotches(rng, 1.2, 1.2) + 0.03 * _blotches(rng, 6.0, 6.0),
        1 + 0.35 * _blotches(rng, 20.0, 20.0) + 0.15 * _blotches(rng, 5.0, 5.0),
    ]
    return np.stack([np.clip(t / t.mean(), 0.2, 1.8) for t in made]).astype(np.float32)


def _blotches(rng: np.random.Generator, along_px: float, across_px: float) -> np.ndarray:
    """Smooth noise of unit deviation."""
    white = rng.standard_normal((TILE_PX, TILE_PX))
    smooth = ndimage.gaussian_filter(white, (along_px, across_px), mode="wrap")
    return smooth / smooth.std()


def _planks(rng: np.random.Generator) -> np.ndarray:
    """Boards along the first axis, their ends in another place in every row."""
    width = TILE_PX // _PLANKS_ACROSS
    tile = np.empty((TILE_PX, TILE_PX))
    for row in range(_PLANKS_ACROSS):
        end = int(rng.integers(TILE_PX))
        along = (np.arange(TILE_PX) - end) % TILE_PX
        board = np.where(along < TILE_PX // 2, *rng.uniform(0.8, 1.15, 2))
        board = np.where(along % (TILE_PX // 2) < _JOINT_PX, 0.6, board)
        tile[:, row * width : (row + 1) * width] = board[:, None]
        tile[:, row * width : row * width + _JOINT_PX] = 0.6
    return tile * (1 + 0.05 * _blotches(rng, 20.0, 0.7))


def _wood(rng: np.random.Generator) -> np.ndarray:
    """Grain along the first axis."""
    return 1 + 0.06 * _blotches(rng, 40.0, 1.0) + 0.06 * _blotches(rng, 60.0, 5.0)


def _weave(rng: np.random.Generator) -> np.ndarray:
    """Threads over and under each other, 32 a tile."""
    phase = np.arange(TILE_PX) * (2 * np.pi * 32 / TILE_PX)
    return 1 + 0.1 * np.sin(phase)[:, None] * np.sin(phase) + 0.06 * _blotches(rng, 8.0, 8.0)
