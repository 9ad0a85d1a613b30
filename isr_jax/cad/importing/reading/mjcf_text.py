"""Foreign MJCF made self-contained: includes put in, files renamed to what is handed over.

MuJoCo reads includes and meshes from disk by itself. Here every file that a document names is
looked up in the given folder alone, and MuJoCo gets one text and the meshes in memory. What a
CAD model does not need (actuators, sensors, tendons, cameras, lights, ...) is taken out, and
textures become one-pixel stand-ins, read elsewhere.
"""

from __future__ import annotations

import dataclasses
import posixpath
import xml.etree.ElementTree as ET

import numpy as np

from ....errors import LibraryError
from ..names import shown
from .files import Files, locate
from .limits import ReadLimits
from .mesh_headers import check_content
from .safe_xml import parse_xml

_DROPPED = {
    "actuator": "actuators",
    "contact": "",
    "custom": "",
    "deformable": "deformable bodies",
    "equality": "equality constraints",
    "keyframe": "",
    "sensor": "",
    "size": "",
    "statistic": "",
    "tendon": "tendons",
    "visual": "",
}
_DROPPED_WITHIN = {
    "camera": "cameras",
    "light": "lights",
    "skin": "skins",
    "composite": "composite bodies",
    "flexcomp": "deformable bodies",
    "flex": "deformable bodies",
}
_REFUSED = {
    "attach": "other models attached to it",
    "extension": "plugins",
    "hfield": "height fields",
    "model": "other models attached to it",
    "plugin": "plugins",
}
_MESH_KINDS = (".stl", ".obj")
_MAX_INCLUDES = 200


@dataclasses.dataclass(frozen=True)
class MjcfTexture:
    """What a document says of one texture."""

    file: str | None
    """Name among the files; None: made by numbers, or missing."""
    rgb: tuple[float, float, float]


@dataclasses.dataclass(frozen=True, eq=False)
class MjcfText:
    """A document that names nothing outside of itself and its meshes."""

    xml: str
    meshes: dict[str, bytes]
    textures: dict[str, MjcfTexture]
    notes: tuple[str, ...]


def included_files(files: Files, name: str, limits: ReadLimits) -> set[str]:
    """Documents and meshes that an MJCF names, of those that are there."""
    found: set[str] = set()
    try:
        root = parse_xml(files.read(name), name, limits)
        expanded = _Expansion(files, name, limits)
        expanded.expand(root, name)
        found |= expanded.included
        found |= {f for f in expanded.asset_files(root) if f is not None}
    except LibraryError:
        pass  # reading the document itself refuses it, with the reason
    return found


def self_contained(files: Files, name: str, limits: ReadLimits) -> MjcfText:
    """Put everything that a document needs into one text.

    Raises:
        LibraryError: It is no MJCF, names what is missing or outside of the folder, or needs
            what is not taken in (plugins, height fields, attached models).
    """
    root = parse_xml(files.read(name), name, limits)
    if root.tag != "mujoco":
        raise LibraryError(f"{shown(name)} is no MJCF: no <mujoco>", "give another file")
    expansion = _Expansion(files, name, limits)
    expansion.expand(root, name)
    notes = _stripped(root, name, limits)
    meshes = expansion.meshes(root)
    textures = expansion.textures(root, notes)
    for compiler in root.iter("compiler"):
        for key in ("meshdir", "texturedir", "assetdir", "strippath", "discardvisual"):
            compiler.attrib.pop(key, None)
        compiler.attrib.pop("fusestatic", None)
    return MjcfText(ET.tostring(root, "unicode"), meshes, textures, tuple(notes))


class _Expansion:
    """Looks up the files of one document, as MuJoCo would: relative to the main document."""

    def __init__(self, files: Files, name: str, limits: ReadLimits) -> None:
        self._files, self._name, self._limits = files, name, limits
        self._folder = posixpath.dirname(name)
        self.included: set[str] = set()
        self._open, self._count = [name], 0

    def expand(self, element: ET.Element, within: str) -> None:
        """Replace every ``<include>`` by what it names."""
        children: list[ET.Element] = []
        for child in element:
            if child.tag == "include":
                children += self._included(child, within)
            else:
                self.expand(child, within)
                children.append(child)
        element[:] = children

    def _included(self, element: ET.Element, within: str) -> list[ET.Element]:
        reference = element.get("file", "")
        found = self._lookup(reference, self._folder, posixpath.dirname(within))
        if found is None:
            raise self._missing(reference)
        self.included.add(found)
        self._count += 1
        if found in self._open or self._count > _MAX_INCLUDES:
            problem = f"{shown(self._name)} includes itself, or more than {_MAX_INCLUDES} files"
            raise LibraryError(problem, "put its parts into one document")
        root = parse_xml(self._files.read(found), found, self._limits)
        self._open.append(found)
        self.expand(root, found)
        self._open.pop()
        return list(root)

    def _lookup(self, reference: str, *folders: str) -> str | None:
        refusal = None
        for folder in folders:
            try:
                found = locate(self._files, folder, reference)
            except LibraryError as error:
                refusal = error
                continue
            if found is not None:
                return found
        if refusal is not None:
            raise refusal
        return None

    def _missing(self, reference: str) -> LibraryError:
        problem = f"{shown(self._name)} needs {shown(reference)}, which is not there"
        hint = "give the folder that holds both; it must have the name that the reference says"
        return LibraryError(problem, hint)

    def _directory(self, root: ET.Element, key: str) -> str:
        """Where the compiler's settings say that meshes or textures are."""
        said = ""
        for compiler in root.iter("compiler"):
            said = compiler.get(key, compiler.get("assetdir", said))
        return posixpath.join(self._folder, said.replace("\\", "/"))

    def asset_files(self, root: ET.Element) -> list[str | None]:
        folder = self._directory(root, "meshdir")
        return [
            self._lookup(e.get("file", ""), folder, self._folder)
            for e in root.iter("mesh")
            if e.get("file")
        ]

    def meshes(self, root: ET.Element) -> dict[str, bytes]:
        """Contents by the new names that the document gets for them."""
        folder, contents = self._directory(root, "meshdir"), {}
        for i, element in enumerate(e for e in root.iter("mesh") if e.get("file")):
            reference = element.get("file", "")
            found = self._lookup(reference, folder, self._folder)
            if found is None:
                raise self._missing(reference)
            ending = posixpath.splitext(found)[1].lower()
            content = self._files.read(found)
            if ending in _MESH_KINDS:
                check_content(content, found, self._limits)
            elif ending != ".msh":
                raise LibraryError(f"{shown(found)} is no mesh that MuJoCo reads", "use STL or OBJ")
            _keep_name(element, reference)
            element.attrib.pop("content_type", None)
            element.set("file", f"mesh_{i}{ending}")
            contents[f"mesh_{i}{ending}"] = content
        return contents

    def textures(self, root: ET.Element, notes: list[str]) -> dict[str, MjcfTexture]:
        """What every texture is; in the document they become single colours."""
        folder, found = self._directory(root, "texturedir"), {}
        for element in root.iter("texture"):
            files = [v for k, v in sorted(element.attrib.items()) if k.startswith("file")]
            name = None
            if files:
                _keep_name(element, files[0])
                name = self._lookup(files[0], folder, self._folder)
                if name is None:
                    notes.append(f"texture {shown(files[0])} is missing: the material's colour")
            rgb = _rgb(element.get("rgb1")) if not files else (1.0, 1.0, 1.0)
            said = element.get("name", "")
            found[said] = MjcfTexture(name, rgb)
            element.attrib.clear()
            stand_in = {"name": said, "type": "2d", "builtin": "flat", "width": "1", "height": "1"}
            element.attrib.update(stand_in)
        return found


def _keep_name(element: ET.Element, reference: str) -> None:
    """An unnamed asset is called after its file, which is about to be renamed."""
    stem = posixpath.splitext(posixpath.basename(reference.replace("\\", "/")))[0]
    element.set("name", element.get("name", stem))


def _rgb(text: str | None) -> tuple[float, float, float]:
    try:
        red, green, blue = (float(v) for v in (text or "0.8 0.8 0.8").split())
    except ValueError:
        return 0.8, 0.8, 0.8
    return red, green, blue


def _stripped(root: ET.Element, name: str, limits: ReadLimits) -> list[str]:
    """Take out what a CAD model does not need; returns notes of what counts."""
    gone = dict.fromkeys(_DROPPED[e.tag] for e in root if e.tag in _DROPPED and len(e))
    root[:] = [child for child in root if child.tag not in _DROPPED]
    for element in root.iter():
        if element.tag in _REFUSED:
            problem = f"{shown(name)} has {_REFUSED[element.tag]}, which are not taken in"
            raise LibraryError(problem, "save the model without them")
        gone |= dict.fromkeys(_DROPPED_WITHIN[c.tag] for c in element if c.tag in _DROPPED_WITHIN)
        element[:] = [child for child in element if child.tag not in _DROPPED_WITHIN]
    _bounded_copies(root, name, limits.max_copies)
    said = sorted(word for word in gone if word)
    return [f"left out: {', '.join(said)}"] if said else []


def _bounded_copies(element: ET.Element, name: str, left: float | int) -> None:
    """Refuse ``<replicate>`` elements that multiply to too many bodies."""
    for child in element:
        count = 1.0
        if child.tag == "replicate":
            try:
                count = max(float(child.get("count", "1")), 1.0)
            except ValueError:
                count = np.inf
        if not count <= left:
            problem = f"{shown(name)} replicates a body too many times"
            raise LibraryError(problem, "raise max_copies if it is meant to")
        _bounded_copies(child, name, left / count)
