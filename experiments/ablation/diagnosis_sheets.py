"""A diagnosis as printed tables."""

from __future__ import annotations

from experiments.bench.sheets import Sheet

from .diagnose import KINDS, Loss, losses, surplus
from .report import FIGURES
from .scores import Judged


def diagnosis_sheets(judged: Judged) -> list[Sheet]:
    """Scores, losses by kind, every true segment, and what was predicted too much."""
    found = losses(judged)
    return [_scores(judged), _by_kind(found), _true(found), _surplus(judged)]


def _scores(judged: Judged) -> Sheet:
    panoptic, scores = judged.scores.panoptic, judged.scores
    values = (
        panoptic.pq,
        panoptic.sq,
        panoptic.rq,
        panoptic.pq_things,
        panoptic.pq_stuff,
        scores.instances.map50,
        scores.observed_boxes.map50,
        scores.boxes.map50,
        sum(v for k, v in judged.mapped.seconds.items() if k != "segmentation"),
    )
    cells = tuple(f.shown(v) for f, v in zip(FIGURES, values, strict=True))
    return Sheet("scores", tuple(f.heading for f in FIGURES), (cells,))


def _by_kind(found: list[Loss]) -> Sheet:
    lines = []
    for kind, meaning in KINDS.items():
        own = [loss for loss in found if loss.kind == kind]
        cost = 100 * sum(loss.pq_lost for loss in own)
        lines.append((kind, str(len(own)), f"{cost:.1f}", meaning))
    headings = ("what became of it", "true segments", "PQ lost, %", "meaning")
    return Sheet("kinds of loss", headings, tuple(lines))


def _true(found: list[Loss]) -> Sheet:
    lines = tuple(
        (
            loss.name,
            str(loss.seen),
            f"{100 * loss.pq_lost:.2f}",
            f"split in {loss.pieces}" if loss.kind == "split" else loss.kind,
            loss.best,
            f"{loss.iou:.2f}",
            loss.detail,
        )
        for loss in found
    )
    headings = ("true", "seen points", "PQ lost, %", "kind", "best", "IoU", "who has it")
    return Sheet("true segments, the dearest first", headings, lines)


def _surplus(judged: Judged) -> Sheet:
    lines = tuple(
        (one.name, str(one.points), f"{100 * one.pq_lost:.2f}", one.detail)
        for one in surplus(judged)
    )
    headings = ("predicted", "points", "PQ lost, %", "lies on")
    return Sheet("predicted segments that match nothing", headings, lines)
