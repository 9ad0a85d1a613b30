"""Border: meshes as OBJ files, with their textures beside them; one file a content."""

from __future__ import annotations

import dataclasses
import hashlib
from pathlib import Path

from ..errors import OutputError
from ..types import Mesh
from .model import Texture
from .mtl import image_name, image_of_mtl, mtl_text, texture_of
from .obj import material_library, obj_text, read_obj_text


def mesh_contents(mesh: Mesh, stem: str, texture: Texture | None = None) -> dict[str, bytes]:
    """Contents by file name: ``<stem>.obj`` and, with a texture, ``<stem>.mtl`` and its image.

    Raises:
        OutputError: The mesh has a texture and no uv, or the texture a name that fits no file.
    """
    if texture is None:
        return {f"{stem}.obj": obj_text(mesh).encode()}
    if mesh.uv is None:
        raise OutputError(f"mesh {stem} has a texture and no uv", "give the mesh its uv")
    try:
        image = image_name(texture)
    except ValueError as error:
        raise OutputError(f"mesh {stem}: {error}", "rename the texture") from None
    return {
        f"{stem}.obj": obj_text(mesh, (f"{stem}.mtl", stem)).encode(),
        f"{stem}.mtl": mtl_text(stem, image).encode(),
        image: texture.content,
    }


def read_mesh_file(path: Path) -> tuple[Mesh, Texture | None]:
    """What `mesh_contents` made; raises ValueError naming the file, or OSError."""
    try:
        text = path.read_text("utf-8")
        mesh, library = read_obj_text(text), material_library(text)
        if library is None:
            return mesh, None
        path = path.with_name(library)
        path = path.with_name(image_of_mtl(path.read_text("utf-8")))
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from None
    return mesh, texture_of(path.name, path.read_bytes())


@dataclasses.dataclass(frozen=True)
class MeshFiles:
    """Mesh files of one folder, named by a stem and a hash of their content."""

    folder: Path
    written: dict[str, str] = dataclasses.field(default_factory=dict)
    """Content hash to file name."""

    def add(self, mesh: Mesh, stem: str, texture: Texture | None = None) -> str:
        """File name of this mesh in the folder; written unless the same content already is.

        Texture coordinates are written with a texture only.
        """
        if texture is None:
            mesh = dataclasses.replace(mesh, uv=None)
        key = hashlib.sha256(obj_text(mesh).encode())
        key.update(b"" if texture is None else texture.content)
        digest = key.hexdigest()
        if digest not in self.written:
            self.written[digest] = f"{stem}_{digest[:10]}.obj"
            for name, content in mesh_contents(mesh, f"{stem}_{digest[:10]}", texture).items():
                write_file(self.folder / name, content)
        return self.written[digest]


def write_text(path: Path, text: str) -> None:
    """Write a text file and its folders; raises `OutputError` where that fails."""
    write_file(path, text.encode())


def write_file(path: Path, content: bytes) -> None:
    """Write a file and its folders; raises `OutputError` where that fails."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
    except OSError as error:
        raise OutputError(
            f"{path}: {error.strerror}", "give an output folder that can be written"
        ) from None
