"""The contact graph: support edges, proximal pairs and attachments, under the matching of entities.

Only things that the camera saw are asked for. Layout carries things, but makes no proximal pair.
Where supports are not annotated nothing is asked, and all rates are None.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Set

from ...scene_file import NOT_ANNOTATED, ROOM_NAME, EntityRecord, SceneFile
from ..figures import Headline, counted, percent, share
from ..matches import Match


@dataclasses.dataclass(frozen=True)
class EdgeScores:
    """Edges of one kind."""

    precision: float | None
    """Correct of the predicted edges; one of a thing that matches no true one is wrong."""
    recall: float | None
    """Correct of the true edges."""
    precision_of_found: float | None
    """Among predicted edges whose both ends match: the contact graph by itself."""
    recall_of_found: float | None
    """Among true edges whose both ends were found."""
    correct: int
    predicted: int
    true: int
    """Edges of seen true things."""
    predicted_of_found: int
    reachable: int
    """True edges whose both ends were found."""

    @staticmethod
    def of(
        correct: int, predicted: int, true: int, predicted_of_found: int, reachable: int
    ) -> EdgeScores:
        """The rates of these counts."""
        return EdgeScores(
            share(correct, predicted),
            share(correct, true),
            share(correct, predicted_of_found),
            share(correct, reachable),
            correct,
            predicted,
            true,
            predicted_of_found,
            reachable,
        )

    def headline(self, name: str) -> Headline:
        return (
            (f"{name} precision", counted(self.precision, self.correct, self.predicted)),
            (f"{name} recall", counted(self.recall, self.correct, self.true)),
            (
                f"{name} precision / recall of found",
                percent(self.precision_of_found, self.recall_of_found),
            ),
        )


@dataclasses.dataclass(frozen=True)
class AttachmentScores:
    """How found things stay up that nothing carries: on a wall, hanging, leaning."""

    accuracy: float | None
    """Share of them that the result says the same of."""
    correct: int
    count: int

    def headline(self) -> Headline:
        return (("attachment right", counted(self.accuracy, self.correct, self.count)),)


def score_supports(truth: SceneFile, result: SceneFile, matches: tuple[Match, ...]) -> EdgeScores:
    """Edges from things to what carries them.

    Layout is named by its class: a wall may be cut into pieces elsewhere than in the truth.
    """
    if not _annotated(truth):
        return _NOTHING_ASKED
    asked = {m.truth for m in matches}
    true = {(child, parent) for child, parent in _supports(truth) if child in asked}
    return _compared(true, _supports(result), matches)


def score_proximal(truth: SceneFile, result: SceneFile, matches: tuple[Match, ...]) -> EdgeScores:
    """Pairs of things so close that their boxes overlap, though neither carries the other."""
    if not _annotated(truth):
        return _NOTHING_ASKED
    asked = {m.truth for m in matches}
    true = {(a, b) for a, b in _close(truth) if a in asked and b in asked}
    predicted = _close(result)
    name = {m.predicted: m.truth for m in matches}
    # A pair has no order: each side is sorted by the names of the truth.
    ordered = {tuple(sorted(pair, key=lambda e: name.get(e, e))) for pair in predicted}
    return _compared({tuple(sorted(pair)) for pair in true}, ordered, matches)


def _annotated(truth: SceneFile) -> bool:
    return truth.settings.get("supports") != NOT_ANNOTATED


_NOTHING_ASKED = EdgeScores.of(0, 0, 0, 0, 0)


def _compared(
    true: Set[tuple[str, ...]], predicted: Set[tuple[str, ...]], matches: tuple[Match, ...]
) -> EdgeScores:
    """Count edges, given by their ends' names in their own scene."""
    true_of = {m.predicted: m.truth for m in matches if m.predicted is not None}
    named = [tuple(e if _is_layout(e) else true_of.get(e) for e in edge) for edge in predicted]
    whole = [edge for edge in named if None not in edge]
    found = set(true_of.values())
    reachable = sum(all(_is_layout(e) or e in found for e in edge) for edge in true)
    correct = sum(edge in true for edge in whole)
    return EdgeScores.of(correct, len(predicted), len(true), len(whole), reachable)


def _supports(scene: SceneFile) -> set[tuple[str, str]]:
    """(thing, what carries it)."""
    by_name = {e.name: e for e in scene.entities}
    return {
        (e.name, _node(by_name[e.parent]))
        for e in scene.entities
        if e.type != "layout" and e.parent is not None and e.parent != ROOM_NAME
    }


def _close(scene: SceneFile) -> set[tuple[str, str]]:
    """Proximal pairs of things."""
    things = {e.name for e in scene.entities if e.type != "layout"}
    return {(a, b) for a, b, _ in scene.proximal if a in things and b in things}


def _node(entity: EntityRecord) -> str:
    return f"layout {entity.class_name}" if entity.type == "layout" else entity.name


def _is_layout(node: str) -> bool:
    return node.startswith("layout ")


def score_attachments(
    truth: SceneFile, result: SceneFile, matches: tuple[Match, ...]
) -> AttachmentScores:
    """For each found thing that nothing carries: whether the result says how it stays up."""
    same = []
    for match in matches if _annotated(truth) else ():
        if match.predicted is None or truth.entity(match.truth).parent is not None:
            continue
        true, found = truth.entity(match.truth), result.entity(match.predicted)
        same.append(found.parent is None and found.attachment == true.attachment)
    return AttachmentScores(share(sum(same), len(same)), sum(same), len(same))
