"""Labels of the map as the entities have them."""

from __future__ import annotations

import numpy as np
from jaxtyping import Int

from ..classes import class_named, classes
from ..types import Entities, PanopticSurface


def final_labels(
    entities: Entities, surface: PanopticSurface
) -> tuple[Int[np.ndarray, " vertices"], Int[np.ndarray, " vertices"]]:
    """Instance and class of each vertex as the entities have them.

    Joined instances have one id; things that became no entity have instance 0.
    """
    rows = {int(i): k for k, i in enumerate(surface.instance_ids)}
    size = int(surface.instance_ids.max(initial=0)) + 1
    id_of, class_of = np.zeros(size, np.int32), np.zeros(size, np.int32)
    for id, row in rows.items():
        class_of[id] = surface.class_ids[row]
        id_of[id] = 0 if classes()[class_of[id]].kind == "thing" else id
    for entity in entities:
        ids = [i for i in (entity.id, *entity.merged_ids) if i in rows and not entity.is_layout]
        id_of[ids], class_of[ids] = entity.id, class_named(entity.class_name).id
    return id_of[surface.instance], class_of[surface.instance]
