"""The labels of a model, as its sidecar names them, in our classes."""

from __future__ import annotations

from typing import Any

import numpy as np

from ..classes import class_named, label_table
from ..classes.label_lists import LABEL_SETS, label_list
from ..errors import ClassError, SegmenterError
from .sidecar_checks import one_of


def read_labels(content: dict[str, Any], source: str) -> tuple[tuple[int, ...], tuple[bool, ...]]:
    """Our class of each of the model's labels, and whether the model tells its instances apart.

    Either ``labels``, a list of our names ("" = none), or ``label_set``. With ``label_order``
    "ids" (the default) label k of the model is the one of that id, and there are ``label_count``
    of them; with "listed" it is the k-th of the official list, counted from 0.

    Raises:
        SegmenterError: A class or a label set is unknown, or ``label_count`` is too small.
    """
    try:
        if "labels" in content:
            infos = [class_named(name or "none") for name in content["labels"]]
            return tuple(i.id for i in infos), tuple(i.kind in ("thing", "dynamic") for i in infos)
        label_set = one_of(source, "label_set", content["label_set"], LABEL_SETS)
    except ClassError as error:
        raise SegmenterError(f"{source}: {error.problem}", error.hint) from None
    order = one_of(source, "label_order", content.get("label_order", "ids"), ("ids", "listed"))
    labels = label_list(label_set)
    ids = np.arange(len(labels)) if order == "listed" else np.array([v.id for v in labels])
    count = content.get("label_count", len(labels)) if order == "listed" else content["label_count"]
    if count <= ids.max():
        raise SegmenterError(
            f"{source}: label_count = {count}, but {label_set} has {len(labels)} labels and ids up "
            f"to {max(v.id for v in labels)}",
            'with label_order = "listed" the model numbers them from 0 without gaps',
        )
    class_of = np.zeros(count, np.int64)
    is_thing = np.zeros(count, bool)
    class_of[ids] = label_table(label_set)[[v.id for v in labels]]
    is_thing[ids] = [v.is_thing for v in labels]
    return tuple(int(c) for c in class_of), tuple(bool(t) for t in is_thing)
