"""Border: GLB, glTF, STL, PLY and COLLADA as mesh parts (trimesh, pycollada)."""

from __future__ import annotations

import io
import posixpath
import warnings

import numpy as np
import trimesh
from trimesh.resolvers import Resolver

from ....errors import LibraryError
from ..names import shown
from .files import Files, locate
from .limits import ReadLimits
from .mesh_headers import check_stl_length, ply_face_count
from .mesh_parts import GREY, MeshPart, Shape, shape_of
from .safe_xml import parse_xml
from .textures import FoundImage, encoded, texture_of

_Y_UP = np.array([0.0, 1.0, 0.0])
_Z_FRONT = np.array([0.0, 0.0, 1.0])
_DAE_UP = {"X_UP": (1.0, 0.0, 0.0), "Y_UP": (0.0, 1.0, 0.0), "Z_UP": (0.0, 0.0, 1.0)}
_GLTF_BROKEN = "its buffers or images are incomplete"


class _Beside(Resolver):
    """Lets trimesh read what a file refers to, and nothing outside the given files."""

    def __init__(self, files: Files, folder: str, notes: list[str]) -> None:
        self._files, self._folder, self._notes = files, folder, notes
        self.refusal: LibraryError | None = None

    def get(self, key: str) -> bytes:
        try:
            name = locate(self._files, self._folder, key)
            if name is not None:
                return self._files.read(name)
        except LibraryError as error:
            self.refusal = error
            raise
        self._notes.append(f"{shown(key)} is missing")
        raise FileNotFoundError(key)

    def write(self, name: str, data) -> None:
        """trimesh asks for it; what is imported is read and never written."""
        raise PermissionError(f"{shown(name)}: what is imported is only read")

    def namespaced(self, namespace: str) -> _Beside:
        return _Beside(self._files, posixpath.join(self._folder, namespace), self._notes)

    def keys(self) -> list[str]:
        return list(self._files.names)


def read_scene(files: Files, name: str, content: bytes, limits: ReadLimits) -> Shape:
    """The parts of one file whose header was checked; raises `LibraryError`."""
    ending, notes = name.rsplit(".", 1)[-1].lower(), []
    said = _stated(content, ending, name, limits)
    if ending == "stl":
        check_stl_length(content, name)
    beside = _Beside(files, posixpath.dirname(name), notes)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            scene = trimesh.load_scene(io.BytesIO(content), file_type=ending, resolver=beside)
            parts = _parts(scene, name, limits, notes)
    except LibraryError:
        raise
    # A foreign parser of a foreign file: whatever it trips over is this file's fault.
    except Exception as error:
        raise _unreadable(name, ending, error) from None
    if beside.refusal is not None:
        raise beside.refusal
    if ending == "ply" and sum(len(s.faces) for s in parts) < ply_face_count(content):
        problem = f"{shown(name)} is cut off: fewer faces than its header says"
        raise LibraryError(problem, "copy or download it again")
    return shape_of(parts, shown(name), notes=tuple(notes), **said)


def _unreadable(name: str, ending: str, error: Exception) -> LibraryError:
    said = " ".join(f"{type(error).__name__}: {error}".split())[:160]
    problem = f"{shown(name)} cannot be read as {ending.upper()} ({said})"
    return LibraryError(problem, "export it again")


def _stated(content: bytes, ending: str, name: str, limits: ReadLimits) -> dict:
    """Unit, up, front: what the format or the file states."""
    if ending in ("glb", "gltf"):
        return {"unit_m": 1.0, "up": _Y_UP, "front": _Z_FRONT}
    if ending != "dae":
        return {}
    root = parse_xml(content, name, limits)
    unit, axis, author = None, None, None
    for element in root.iter():
        tag = element.tag.rsplit("}", 1)[-1]
        if tag == "unit" and unit is None:
            unit = _positive(element.get("meter", "1"))
        elif tag == "up_axis" and axis is None:
            axis = _DAE_UP.get((element.text or "").strip().upper())
        elif tag == "author" and author is None:
            author = (element.text or "").strip() or None
    # COLLADA's own defaults: one metre, y up.
    up = np.array(_DAE_UP["Y_UP"] if axis is None else axis)
    return {"unit_m": unit, "up": up, "creator": author}


def _positive(text: str) -> float | None:
    try:
        value = float(text)
    except ValueError:
        return None
    return value if 0 < value < np.inf else None


def _parts(scene, name: str, limits: ReadLimits, notes: list[str]) -> list[MeshPart]:
    parts = []
    for node in scene.graph.nodes_geometry:
        T, key = scene.graph[node]
        geometry = scene.geometry[key]
        if isinstance(geometry, trimesh.Trimesh) and len(geometry.faces):
            parts.append(_part(geometry, np.asarray(T), str(node), name, limits, notes))
    return parts


def _part(geometry, T, node: str, name: str, limits: ReadLimits, notes: list[str]) -> MeshPart:
    vertices = np.asarray(geometry.vertices, np.float64) @ T[:3, :3].T + T[:3, 3]
    faces = np.asarray(geometry.faces)
    material = getattr(geometry.visual, "material", None)
    uv = getattr(geometry.visual, "uv", None)
    uv = None if uv is None or len(uv) != len(vertices) else np.asarray(uv)[faces]
    if np.linalg.det(T[:3, :3]) < 0:
        faces, uv = faces[:, ::-1], None if uv is None else uv[:, ::-1]
    image = _image(material, name, limits, notes)
    return MeshPart(
        name=str(getattr(material, "name", None) or node),
        vertices=vertices,
        faces=faces,
        uv=uv,
        colors=_vertex_colors(geometry),
        rgba=_rgba(geometry, material, image),
        texture=None if image is None else image.texture,
        group=node,
    )


def _vertex_colors(geometry) -> np.ndarray | None:
    visual = geometry.visual
    if visual.kind != "vertex":
        return None
    return np.asarray(visual.vertex_colors)[:, :3].astype(np.uint8)


def _rgba(geometry, material, image: FoundImage | None):
    if image is not None:
        return (*image.mean_rgb, 1.0)
    if geometry.visual.kind in ("vertex", "face"):
        colors = np.asarray(geometry.visual.face_colors, np.float64)
        red, green, blue, alpha = (float(v) for v in np.round(colors.mean(0) / 255.0, 4))
        return red, green, blue, alpha
    found = None if material is None else getattr(material, "baseColorFactor", None)
    if found is None:
        found = None if material is None else getattr(material, "diffuse", None)
    if found is None:
        return GREY
    found = np.asarray(found, np.float64).reshape(-1)
    if found.max(initial=0.0) > 1.0:
        found = found / 255.0
    red, green, blue, alpha = (float(v) for v in np.round([*found[:3], *found[3:4], 1.0][:4], 4))
    return red, green, blue, alpha


def _image(material, name: str, limits: ReadLimits, notes: list[str]) -> FoundImage | None:
    image = None if material is None else getattr(material, "baseColorTexture", None)
    if image is None and material is not None:
        image = getattr(material, "image", None)
    if image is None:
        return None
    stem = posixpath.splitext(posixpath.basename(name))[0]
    try:
        called = f"{stem}_{getattr(material, 'name', None) or 'texture'}"
        found = texture_of(encoded(image), called, limits)
    except (LibraryError, OSError, ValueError) as error:
        said = error.problem if isinstance(error, LibraryError) else str(error)
        notes.append(f"{said}: the material's colour")
        return None
    if found.note:
        notes.append(found.note)
    return found
