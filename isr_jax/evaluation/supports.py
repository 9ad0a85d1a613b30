"""Supports: which thing stands on what, compared under the matching of entities."""

from __future__ import annotations

from ..scene_file import ROOM_NAME, EntityRecord, SceneFile
from .report import Match, SupportScores


def score_supports(
    truth: SceneFile, result: SceneFile, matches: tuple[Match, ...]
) -> SupportScores:
    """Precision and recall of the edges from things to what carries them.

    Layout is named by its class: a wall may be cut into pieces elsewhere than in the truth. Only
    things in ``matches`` (those that the camera saw) are asked for.
    """
    true_of = {m.predicted: m.truth for m in matches if m.predicted is not None}
    asked = {m.truth for m in matches}
    true_edges = {child: p for child, p in _edges(truth).items() if child in asked}
    predicted = _edges(result)
    correct = 0
    for child, parent in predicted.items():
        named = parent if _is_layout(parent) else true_of.get(parent)
        true_child = true_of.get(child)
        correct += true_child in true_edges and true_edges[true_child] == named
    found = set(true_of.values())
    reachable = sum(c in found and (p in found or _is_layout(p)) for c, p in true_edges.items())
    attached = _attachments(truth, result, matches)
    return SupportScores(
        correct, len(predicted), len(true_edges), reachable, sum(attached), len(attached)
    )


def _edges(scene: SceneFile) -> dict[str, str]:
    """What carries each thing that is carried."""
    by_name = {e.name: e for e in scene.entities}
    return {
        e.name: _node(by_name[e.parent])
        for e in scene.entities
        if e.type != "layout" and e.parent is not None and e.parent != ROOM_NAME
    }


def _node(entity: EntityRecord) -> str:
    return f"layout {entity.class_name}" if entity.type == "layout" else entity.name


def _is_layout(node: str) -> bool:
    return node.startswith("layout ")


def _attachments(truth: SceneFile, result: SceneFile, matches: tuple[Match, ...]) -> list[bool]:
    """For each found thing that nothing carries: whether the result says how it stays up."""
    same = []
    for match in matches:
        if match.predicted is None or truth.entity(match.truth).parent is not None:
            continue
        true, found = truth.entity(match.truth), result.entity(match.predicted)
        same.append(found.parent is None and found.attachment == true.attachment)
    return same
