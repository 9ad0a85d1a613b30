"""Turn a walk through a room with an RGB-D camera into a room that a robot can act in.

    import isr_jax as isr

    sequence = isr.open_sequence("captures/kitchen")
    masks = isr.open_segmenter("yolox.onnx+deeplab.onnx", "captures/kitchen")
    scene = isr.reconstruct(sequence, segmenter=masks, library=isr.load_library("cad_db"))
    scene.save("out/kitchen")
    print(isr.settle("out/kitchen/scene.xml"))

Names are imported when they are first used, so that ``isr --help`` answers at once.
"""

# pyright: strict

from __future__ import annotations

import importlib
import warnings
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .alignment import (
        AlignmentProblem,
        AlignmentSolution,
        AlignmentWeights,
        align,
        alignment_error,
    )
    from .borders import simulation
    from .cad import build_library, default_library, fit_cad, load_library, open_library
    from .config import Settings, preset, with_overrides
    from .datasets import inspect_sequence, open_sequence
    from .demonstration.demo import demo
    from .demonstration.film import film_room
    from .errors import IsrError
    from .evaluation import evaluate
    from .map_runs.live import LiveMap
    from .map_runs.make_map import make_map
    from .pipeline import furnish_scenes, reconstruct, replace_with_cad, run
    from .scene import Scene, alignment_problem, alignment_surfaces, load_scene
    from .scene_file import read_scene
    from .segmentation import open_segmenter
    from .stability import settle
    from .viewer import view

_HOME = {
    "AlignmentProblem": "alignment",
    "AlignmentSolution": "alignment",
    "AlignmentWeights": "alignment",
    "IsrError": "errors",
    "LiveMap": "map_runs.live",
    "Scene": "scene",
    "Settings": "config",
    "align": "alignment",
    "alignment_error": "alignment",
    "alignment_problem": "scene",
    "alignment_surfaces": "scene",
    "build_library": "cad",
    "default_library": "cad",
    "demo": "demonstration.demo",
    "evaluate": "evaluation",
    "film_room": "demonstration.film",
    "fit_cad": "cad",
    "furnish_scenes": "pipeline",
    "inspect_sequence": "datasets",
    "load_library": "cad",
    "load_scene": "scene",
    "make_map": "map_runs.make_map",
    "open_library": "cad",
    "open_segmenter": "segmentation",
    "open_sequence": "datasets",
    "preset": "config",
    "read_scene": "scene_file",
    "reconstruct": "pipeline",
    "replace_with_cad": "pipeline",
    "run": "pipeline",
    "settle": "stability",
    "simulation": "borders.simulation",
    "view": "viewer",
    "with_overrides": "config",
}

_MODULES = {"simulation"}
"""Public as a whole."""


_RENAMED = {"fit": "fit_cad", "furnish": "replace_with_cad"}
"""Old names, kept for one release."""


def __getattr__(name: str) -> Any:
    if name in _RENAMED:
        message = f"isr_jax.{name} is called {_RENAMED[name]} now"
        warnings.warn(message, DeprecationWarning, stacklevel=2)
        name = _RENAMED[name]
    if name not in _HOME:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    home = importlib.import_module(f".{_HOME[name]}", __name__)
    return home if name in _MODULES else getattr(home, name)


def __dir__() -> list[str]:
    return sorted(__all__)


__all__ = [
    "AlignmentProblem",
    "AlignmentSolution",
    "AlignmentWeights",
    "IsrError",
    "LiveMap",
    "Scene",
    "Settings",
    "align",
    "alignment_error",
    "alignment_problem",
    "alignment_surfaces",
    "build_library",
    "default_library",
    "demo",
    "evaluate",
    "film_room",
    "fit_cad",
    "furnish_scenes",
    "inspect_sequence",
    "load_library",
    "load_scene",
    "make_map",
    "open_library",
    "open_segmenter",
    "open_sequence",
    "preset",
    "read_scene",
    "reconstruct",
    "replace_with_cad",
    "run",
    "settle",
    "simulation",
    "view",
    "with_overrides",
]
