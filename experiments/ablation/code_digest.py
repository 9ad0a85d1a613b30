"""Which code made a result: the sources of the stages that it went through."""

from __future__ import annotations

import functools
import hashlib
from pathlib import Path

import isr_jax

_SHARED = ("geometry", "classes", "classes/classes.csv", "types.py")
SEGMENTATION = ("datasets", "segmentation", *_SHARED)
WHOLE = (*SEGMENTATION, "mapping", "entities", "contact_graph", "evaluation", "scene_file.py")


@functools.cache
def code_digest(parts: tuple[str, ...]) -> str:
    """Of these modules and folders of the package, as they lie there when first asked for."""
    package, found = Path(isr_jax.__file__).parent, hashlib.blake2b(digest_size=16)
    for part in parts:
        path = package / part
        for file in sorted(path.rglob("*.py")) if path.is_dir() else [path]:
            found.update(f"{file.relative_to(package)}\n".encode())
            found.update(file.read_bytes())
    return found.hexdigest()
