"""What the first bytes of a mesh file say: its true format, how many triangles it claims, and
whether all of it is there."""

from __future__ import annotations

import json
import re
import struct
from typing import Any

from ....errors import LibraryError
from ..names import shown
from .limits import ReadLimits
from .obj_format import face_count

_MAGIC = (
    (b"glTF", "GLB"),
    (b"\x89PNG", "PNG"),
    (b"\xff\xd8\xff", "JPEG"),
    (b"PK\x03\x04", "ZIP"),
    (b"%PDF", "PDF"),
    (b"Kaydara FBX", "FBX"),
    (b"\x1f\x8b", "gzip"),
    (b"BLENDER", "Blender"),
)
_XML = re.compile(rb"^\s*(?:\xef\xbb\xbf)?\s*<[?!A-Za-z]")
_PLY_COUNT = re.compile(rb"^element\s+(\w+)\s+(\d+)", re.MULTILINE)
_STL_HEADER, _STL_TRIANGLE = 84, 50


def check_content(content: bytes, name: str, limits: ReadLimits) -> None:
    """Refuse what is no mesh of its ending, is cut off, or claims too many triangles.

    Nothing is decoded, so that a file that claims 50 million triangles costs nothing.

    Raises:
        LibraryError: It is one of these, or empty.
    """
    ending = name.rsplit(".", 1)[-1].lower()
    if not content.strip():
        raise LibraryError(f"{shown(name)} is empty", "restore the file")
    _check_format(content, ending, name)
    count = _COUNTS[ending](content, name)
    if count > limits.max_faces:
        problem = f"{shown(name)} has {count} triangles, above {limits.max_faces}"
        raise LibraryError(problem, "simplify it first, or raise max_faces")


def _check_format(content: bytes, ending: str, name: str) -> None:
    for magic, kind in _MAGIC:
        if content.startswith(magic) and ending != kind.lower():
            raise _wrong_ending(name, kind, ending)
    is_xml = _XML.match(content[:200]) is not None
    if is_xml != (ending == "dae"):
        raise _wrong_ending(name, "XML" if is_xml else "no XML", ending)


def _wrong_ending(name: str, kind: str, ending: str) -> LibraryError:
    problem = f"{shown(name)} is {kind}, not {ending.upper()} as its name says"
    return LibraryError(problem, "give the file the ending of its format")


def _cut_off(name: str, has: int, wants: int) -> LibraryError:
    problem = f"{shown(name)} is cut off: {has} of {wants} bytes"
    return LibraryError(problem, "copy or download it again")


def _stl_faces(content: bytes, name: str) -> int:
    if content.lstrip()[:5] == b"solid" and b"facet" in content[:2000]:
        if b"endsolid" not in content[-2000:]:
            problem = f"{shown(name)} is cut off: no endsolid"
            raise LibraryError(problem, "copy or download it again")
        return content.count(b"endfacet")
    if len(content) < _STL_HEADER:
        raise _cut_off(name, len(content), _STL_HEADER)
    (count,) = struct.unpack_from("<I", content, 80)
    return count


def check_stl_length(content: bytes, name: str) -> None:
    """Refuse a binary STL that is shorter than its triangles; tested after their number.

    Raises:
        LibraryError: It is shorter.
    """
    if content.lstrip()[:5] == b"solid" and b"facet" in content[:2000]:
        return
    wants = _STL_HEADER + _STL_TRIANGLE * struct.unpack_from("<I", content, 80)[0]
    if len(content) < wants:
        raise _cut_off(name, len(content), wants)


def _ply_faces(content: bytes, name: str) -> int:
    head, found, _ = content[:100_000].partition(b"end_header")
    if not content.startswith(b"ply") or not found:
        raise LibraryError(f"{shown(name)} has no PLY header", "export it again")
    counts = {key: int(number) for key, number in _PLY_COUNT.findall(head)}
    return max(counts.get(b"face", 0), counts.get(b"vertex", 0) // 3)


def ply_face_count(content: bytes) -> int:
    """Faces that the header of a PLY declares."""
    counts = dict(_PLY_COUNT.findall(content[:100_000].partition(b"end_header")[0]))
    return int(counts.get(b"face", 0))


def _glb_faces(content: bytes, name: str) -> int:
    if not content.startswith(b"glTF") or len(content) < 20:
        raise LibraryError(f"{shown(name)} has no GLB header", "export it again")
    (length,) = struct.unpack_from("<I", content, 8)
    if len(content) < length:
        raise _cut_off(name, len(content), length)
    (json_length,) = struct.unpack_from("<I", content, 12)
    return _gltf_triangles(content[20 : 20 + json_length], name)


def _gltf_triangles(content: bytes, name: str) -> int:
    tree = gltf_tree(content, name)
    try:
        accessors = tree.get("accessors", [])
        primitives = [p for m in tree.get("meshes", []) for p in m.get("primitives", [])]
        rows = [p.get("indices", p["attributes"]["POSITION"]) for p in primitives]
        return sum(int(accessors[row]["count"]) // 3 for row in rows)
    except (AttributeError, IndexError, KeyError, TypeError, ValueError) as error:
        problem = f"{shown(name)}: its glTF is incomplete ({error!r})"
        raise LibraryError(problem, "export it again") from None


def gltf_tree(content: bytes, name: str) -> dict[str, Any]:
    """The JSON of a glTF.

    Raises:
        LibraryError: It is no JSON object.
    """
    try:
        tree = json.loads(content)
    except (ValueError, RecursionError) as error:
        raise LibraryError(f"{shown(name)} is no glTF: {error}", "export it again") from None
    if not isinstance(tree, dict):
        raise LibraryError(f"{shown(name)} is no glTF: no object", "export it again")
    return tree


def _obj_faces(content: bytes, name: str) -> int:
    return face_count(content)


def _dae_faces(content: bytes, name: str) -> int:
    counts = re.findall(rb"<(?:triangles|polylist|polygons)[^>]*\scount=[\"'](\d+)", content)
    return sum(int(number) for number in counts)


_COUNTS = {
    "stl": _stl_faces,
    "ply": _ply_faces,
    "glb": _glb_faces,
    "gltf": _gltf_triangles,
    "obj": _obj_faces,
    "dae": _dae_faces,
}
MESH_ENDINGS = tuple(f".{ending}" for ending in _COUNTS)
"""Of the mesh files that are read."""
