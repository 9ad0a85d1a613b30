"""Border: one mesh file of any format as a shape, with its colours and textures."""

from __future__ import annotations

import dataclasses
import posixpath

from ..names import shown
from .files import Files, locate
from .limits import ReadLimits
from .mesh_headers import check_content
from .mesh_parts import MeshPart, Shape, shape_of
from .mtl_format import MtlMaterial, read_mtl
from .obj_format import ObjFile, parts_of, read_obj
from .scene_formats import read_scene
from .textures import Images


def read_shape(files: Files, name: str, limits: ReadLimits, *, by_group: bool = False) -> Shape:
    """Read a mesh file.

    Args:
        files: Where it is.
        name: The file.
        limits: Bounds on its size.
        by_group: Keep the objects of an OBJ apart, for those whose names mean something.

    Raises:
        LibraryError: It cannot be read, is beyond the bounds, holds no faces, or refers to
            files outside of ``files``.
    """
    content = files.read(name)
    check_content(content, name, limits)
    if not name.lower().endswith(".obj"):
        return read_scene(files, name, content, limits)
    obj = read_obj(content, shown(name))
    images = Images(files, limits)
    folder = posixpath.dirname(name)
    materials = _materials(files, folder, obj, images.notes)
    coloured = [_coloured(s, materials, images, folder) for s in parts_of(obj, by_group)]
    shape = shape_of(coloured, shown(name))
    return dataclasses.replace(shape, notes=(*shape.notes, *dict.fromkeys(images.notes)))


def _materials(files: Files, folder: str, obj: ObjFile, notes: list[str]) -> dict[str, MtlMaterial]:
    found: dict[str, MtlMaterial] = {}
    for library in obj.libraries:
        name = locate(files, folder, library)
        if name is None:
            notes.append(f"materials {shown(library)} are missing: grey")
            continue
        content = files.read(name)
        try:
            found |= read_mtl(content.decode())
        except UnicodeDecodeError:
            found |= read_mtl(content.decode("latin-1"))
    return found


def _coloured(
    part: MeshPart, materials: dict[str, MtlMaterial], images: Images, folder: str
) -> MeshPart:
    material = materials.get(part.name)
    if material is None:
        if materials and part.name:
            images.notes.append(f"material {shown(part.name)} is not in its file: grey")
        return part
    image = None if material.image is None else images.find(folder, material.image)
    if image is None:
        return dataclasses.replace(part, rgba=material.rgba)
    if part.uv is None:
        images.notes.append(f"texture {image.texture.name} has no coordinates: its mean colour")
    rgba = (*image.mean_rgb, material.rgba[3])
    return dataclasses.replace(part, rgba=rgba, texture=image.texture)
