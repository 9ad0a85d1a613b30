"""Class and spatial relations of a thing: what it is, what carries it, what it carries."""

from __future__ import annotations

import dataclasses

from ...classes import class_named
from ...scene_file import ROOM_NAME, EntityRecord, SceneFile
from ..matches import Match

SAME_GROUP = 0.5
"""Credit for a class that may stand for the true one (a desk for a table) but is another."""


def class_agreement(true: str, found: str) -> float:
    """1 for the same class, 0.5 for one of its match group or its hung form, else 0."""
    if true == found:
        return 1.0
    a, b = class_named(true), class_named(found)
    hung = found == a.hung_class or true == b.hung_class
    return SAME_GROUP if hung or a.match_group == b.match_group else 0.0


@dataclasses.dataclass(frozen=True)
class Supports:
    """Support edges of one scene, its things named as the truth names them."""

    parent: dict[str, str]
    """By thing: what carries it, else how it stays up."""
    children: dict[str, frozenset[str]]
    """By thing: what it carries."""

    def around(self, name: str) -> frozenset[str]:
        """The edges that a thing has."""
        below = {f"on {self.parent[name]}"} if name in self.parent else set()
        return frozenset(below | {f"under {c}" for c in self.children.get(name, ())})


def true_supports(scene: SceneFile, matches: tuple[Match, ...]) -> Supports:
    """Edges of the truth; children that the camera hardly saw are not asked for."""
    seen = {m.truth for m in matches}
    return _supports(scene, {e.name: e.name for e in scene.entities}, seen)


def found_supports(scene: SceneFile, matches: tuple[Match, ...]) -> Supports:
    """Edges of the result; what stands for nothing true keeps a name that the truth has not."""
    named = {e.name: f"false {e.name}" for e in scene.entities}
    named |= {m.predicted: m.truth for m in matches if m.predicted is not None}
    return _supports(scene, named, set(named.values()))


def _supports(scene: SceneFile, named: dict[str, str], asked: set[str]) -> Supports:
    by_name = {e.name: e for e in scene.entities}
    parent: dict[str, str] = {}
    children: dict[str, set[str]] = {}
    for e in scene.entities:
        if e.type == "layout":
            continue
        below = None if e.parent in (None, ROOM_NAME) else by_name[e.parent]
        parent[named[e.name]] = _node(below, e, named)
        if below is not None and named[e.name] in asked:
            children.setdefault(named[below.name], set()).add(named[e.name])
    return Supports(parent, {name: frozenset(c) for name, c in children.items()})


def _node(below: EntityRecord | None, entity: EntityRecord, named: dict[str, str]) -> str:
    """Layout by its class: a wall may be cut into pieces elsewhere than in the truth."""
    if below is None:
        return f"nothing, {entity.attachment}"
    return f"any {below.class_name}" if below.type == "layout" else named[below.name]


def edge_agreement(true: Supports, found: Supports, name: str) -> float:
    """F1 of the support edges of one thing: 2 |both| / (|true| + |found|)."""
    a, b = true.around(name), found.around(name)
    return 2 * len(a & b) / (len(a) + len(b)) if a or b else 1.0
