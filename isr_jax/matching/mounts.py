"""Which models of a class can stay up where an entity is (host)."""

from __future__ import annotations

import numpy as np
from jaxtyping import Int

from ..classes import class_named
from ..library import CadLibrary
from ..types import UNSUPPORTED, ContactGraph

_HUNG = ("wall", "opening")


def mountable(
    models: Int[np.ndarray, " models"],
    library: CadLibrary,
    graph: ContactGraph,
    position: int,
) -> Int[np.ndarray, " kept"]:
    """Of the models for an entity those that are mounted as it is held.

    A lamp stands, but some lamps hang on walls. Where a model is mounted on a wall while things
    of its class stand, it is for what the graph has on a wall or hanging, and there, on a wall,
    those that stand are left out if any hangs. One for an opening in furniture (an oven) is also
    for what nothing is known to carry: the furniture about it hides what holds it.

    Args:
        models: Positions in the library.
        library: Where they are.
        graph: What carries or holds the entity.
        position: Of the entity.
    """
    attachment = graph.attachment[position]
    held = attachment in ("wall", "hanging")
    hidden = attachment == "none" and graph.parent[position] == UNSUPPORTED
    allowed = {"wall": held, "opening": held or hidden}
    hung = np.array([_hung(library, i) for i in models.tolist()], bool)
    if attachment == "wall" and hung.any():
        return models[hung]
    fits = [not h or allowed[library[i].mount] for i, h in zip(models.tolist(), hung, strict=True)]
    return models[np.array(fits, bool)]


def _hung(library: CadLibrary, position: int) -> bool:
    """Whether a model is mounted on a wall or in an opening while things of its class stand."""
    model = library[position]
    return model.mount in _HUNG and class_named(model.class_name).mount not in _HUNG
