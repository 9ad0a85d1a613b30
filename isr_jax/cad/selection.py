"""Models of a library that a user names."""

from __future__ import annotations

import difflib
from collections.abc import Sequence

from ..errors import LibraryError
from ..library import CadLibrary, CadModel


def of_classes(library: CadLibrary, class_names: Sequence[str]) -> list[CadModel]:
    """Models of these classes, of all where none is named.

    Raises:
        LibraryError: The library holds none of one of them; says what it does hold.
    """
    found = [m for m in library.models if not class_names or m.class_name in class_names]
    missing = set(class_names) - {model.class_name for model in found}
    if missing:
        known = ", ".join(sorted({model.class_name for model in library.models}))
        problem = f"{library.source} holds no {', no '.join(sorted(missing))}"
        raise LibraryError(problem, f"its classes: {known}")
    return found


def model_named(library: CadLibrary, cad_id: str) -> CadModel:
    """The model of this id; raises `LibraryError` that names the nearest ones."""
    ids = [model.id for model in library.models]
    if cad_id not in ids:
        near = difflib.get_close_matches(cad_id, ids, n=5, cutoff=0.3)
        problem = f"{library.source} holds no model {cad_id!r}"
        hint = f"did you mean {', '.join(near)}?" if near else "`isr cad list` prints all"
        raise LibraryError(problem, hint)
    return library.by_id(cad_id)
