"""From what a user writes after ``--segmenter`` to a source of masks."""

from __future__ import annotations

from pathlib import Path

from ..config import SegmentationSettings
from ..errors import SegmenterError
from .boxes_semantics import BoxesAndSemantics
from .file_masks import FileMasks
from .noise_rates import LEVELS
from .onnx_model import OnnxModel
from .panoptic_model import PanopticModel
from .segmenter import Segmenter
from .simulated import SimulatedSegmenter
from .true_views import read_true_views

_ALTERNATIVES = (
    "use a folder with panoptic.json (or masks:FOLDER, masks:FILE.json), panoptic.onnx, "
    "boxes.onnx+semantics.onnx, or, where the sequence has true masks, simulated:"
    + "|".join(LEVELS)
)


def open_segmenter(
    spec: str,
    sequence_dir: Path | str,
    *,
    settings: SegmentationSettings | None = None,
    seed: int = 0,
) -> Segmenter:
    """The segmenter that ``spec`` names.

    Args:
        spec: ``simulated[:LEVEL]``; ``masks[:PATH]`` with a COCO panoptic JSON file or its folder,
            or such a folder; ``A.onnx+B.onnx`` (one model of boxes or instances, one of semantics,
            or one alone) or ``A.onnx`` of panoptic kind; "" takes the masks of the sequence.
        sequence_dir: The sequence's folder: where its own masks are.
        settings: Of this stage; the defaults if None. ``onnx_provider`` and ``onnx_threads`` say
            where models run.
        seed: Of the simulated segmenter.

    Raises:
        SegmenterError: ``spec`` names nothing that is known or there, or models that do not go
            together.
    """
    sequence_dir, settings = Path(sequence_dir), settings or SegmentationSettings()
    head, _, rest = spec.partition(":")
    if head == "simulated":
        views = read_true_views(sequence_dir / "truth" / "views.json")
        return SimulatedSegmenter(FileMasks(sequence_dir), rest or "strong", seed=seed, views=views)
    if spec.endswith(".onnx"):
        return _from_models(spec, settings)
    if head == "masks":
        return FileMasks(Path(rest) if rest else sequence_dir)
    if spec and (Path(spec) / "panoptic.json").is_file():
        return FileMasks(spec)
    if spec:
        raise SegmenterError(f"unknown segmenter {spec!r}", _ALTERNATIVES)
    if not (sequence_dir / "panoptic.json").is_file():
        raise SegmenterError(f"{sequence_dir} has no masks of its own", _ALTERNATIVES)
    return FileMasks(sequence_dir)


def _from_models(spec: str, settings: SegmentationSettings) -> Segmenter:
    parts: dict[str, OnnxModel] = {}
    for path in spec.split("+"):
        model = OnnxModel(path, provider=settings.onnx_provider, threads=settings.onnx_threads)
        kind = model.sidecar.kind
        part = "boxes" if kind == "instances" else kind
        if part in parts:
            other = parts[part].sidecar.kind
            raise SegmenterError(
                f"{spec}: two models of {kind}" if kind == other else f"{spec}: {other} and {kind}",
                "give one model of boxes or instances and one of semantics",
            )
        parts[part] = model
    if "panoptic" not in parts:
        return BoxesAndSemantics(parts.get("boxes"), parts.get("semantics"), settings)
    if len(parts) > 1:
        raise SegmenterError(
            f"{spec}: {parts['panoptic'].path.name} is panoptic: it finds things and stuff alone",
            "give it alone",
        )
    return PanopticModel(parts["panoptic"], settings)
