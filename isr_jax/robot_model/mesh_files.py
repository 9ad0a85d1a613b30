"""Border: writes meshes as OBJ files, one file a content."""

from __future__ import annotations

import dataclasses
import hashlib
from pathlib import Path

from ..errors import OutputError
from ..types import Mesh
from .obj import obj_text


@dataclasses.dataclass(frozen=True)
class MeshFiles:
    """Mesh files of one folder, named by a stem and a hash of their content."""

    folder: Path
    written: dict[str, str] = dataclasses.field(default_factory=dict)
    """Content hash to file name."""

    def add(self, mesh: Mesh, stem: str) -> str:
        """File name of this mesh in the folder; written unless the same content already is."""
        text = obj_text(mesh)
        digest = hashlib.sha256(text.encode()).hexdigest()
        if digest not in self.written:
            name = f"{stem}_{digest[:10]}.obj"
            write_text(self.folder / name, text)
            self.written[digest] = name
        return self.written[digest]


def write_text(path: Path, text: str) -> None:
    """Write a text file and its folders; raises `OutputError` where that fails."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, "utf-8", newline="\n")
    except OSError as error:
        raise OutputError(
            f"{path}: {error.strerror}", "give an output folder that can be written"
        ) from None
