"""Border: networkx. The contact graph as a networkx graph, for those who want its algorithms."""

from __future__ import annotations

import networkx as nx

from ..types import ROOM, ContactGraph, Entities

ROOM_NODE = "room"


def to_networkx(entities: Entities, graph: ContactGraph) -> nx.DiGraph:
    """A directed graph of entity names below the root ``room``.

    Edges of ``kind="support"`` run from parent to child with ``plane`` (of the parent, -1 from the
    room) and ``score``; edges of ``kind="proximal"`` run both ways with ``depth_m``. What nothing
    carries has no support edge and says how it stays up in its ``attachment``.
    """
    out = nx.DiGraph()
    out.add_node(ROOM_NODE, id=0, class_name=ROOM_NODE, is_layout=False, attachment="none")
    for entity, attachment in zip(entities, graph.attachment, strict=True):
        out.add_node(
            entity.name,
            id=entity.id,
            class_name=entity.class_name,
            is_layout=entity.is_layout,
            attachment=attachment,
        )
    for child, parent in enumerate(graph.parent.tolist()):
        if parent == ROOM:
            out.add_edge(ROOM_NODE, entities[child].name, kind="support", plane=-1, score=1.0)
        elif parent >= 0:
            plane, score = int(graph.support_plane[child]), float(graph.score[child])
            names = entities[parent].name, entities[child].name
            out.add_edge(*names, kind="support", plane=plane, score=score)
    for (a, b), depth in zip(graph.proximal.tolist(), graph.proximal_depth_m, strict=True):
        for names in ((a, b), (b, a)):
            ends = (entities[i].name for i in names)
            out.add_edge(*ends, kind="proximal", depth_m=float(depth))
    return out
