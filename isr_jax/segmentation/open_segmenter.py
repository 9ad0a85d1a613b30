"""From what a user writes after ``--segmenter`` to a source of masks."""

from __future__ import annotations

from pathlib import Path

from ..config import SegmentationSettings
from ..errors import SegmenterError
from .boxes_semantics import BoxesAndSemantics
from .file_masks import FileMasks
from .noise_rates import LEVELS
from .onnx_model import OnnxModel
from .segmenter import Segmenter
from .simulated import SimulatedSegmenter
from .true_views import read_true_views

_ALTERNATIVES = (
    "use a folder with panoptic.json (or masks:FOLDER), boxes.onnx+semantics.onnx, or, where the "
    "sequence has true masks, simulated:" + "|".join(LEVELS)
)


def open_segmenter(
    spec: str,
    sequence_dir: Path | str,
    *,
    settings: SegmentationSettings | None = None,
    seed: int = 0,
    threads: int = 0,
) -> Segmenter:
    """The segmenter that ``spec`` names.

    Args:
        spec: ``simulated[:LEVEL]``; ``masks[:FOLDER]`` or a folder with panoptic.json;
            ``A.onnx+B.onnx`` (one model of boxes, one of semantics, or one alone); "" takes the
            masks of the sequence.
        sequence_dir: The sequence's folder: where its own masks are.
        settings: Of this stage; the defaults if None.
        seed: Of the simulated segmenter.
        threads: Of the ONNX models; 0 = all cores.
    """
    sequence_dir, settings = Path(sequence_dir), settings or SegmentationSettings()
    head, _, rest = spec.partition(":")
    if head == "simulated":
        views = read_true_views(sequence_dir / "truth" / "views.json")
        return SimulatedSegmenter(FileMasks(sequence_dir), rest or "strong", seed=seed, views=views)
    if spec.endswith(".onnx"):
        return _from_models(spec, settings, threads)
    if head == "masks":
        return FileMasks(Path(rest) if rest else sequence_dir)
    if spec and (Path(spec) / "panoptic.json").is_file():
        return FileMasks(spec)
    if spec:
        raise SegmenterError(f"unknown segmenter {spec!r}", _ALTERNATIVES)
    if not (sequence_dir / "panoptic.json").is_file():
        raise SegmenterError(f"{sequence_dir} has no masks of its own", _ALTERNATIVES)
    return FileMasks(sequence_dir)


def _from_models(spec: str, settings: SegmentationSettings, threads: int) -> Segmenter:
    by_kind: dict[str, OnnxModel] = {}
    for path in spec.split("+"):
        model = OnnxModel(path, threads=threads)
        if model.sidecar.kind in by_kind:
            raise SegmenterError(
                f"{spec}: two models of {model.sidecar.kind}",
                "give one model of boxes and one of semantics",
            )
        by_kind[model.sidecar.kind] = model
    return BoxesAndSemantics(by_kind.get("boxes"), by_kind.get("semantics"), settings)
