"""What can be taken in from a folder, an archive or a file: one item per model or document."""

from __future__ import annotations

import dataclasses
import posixpath
import re
from collections.abc import Callable
from pathlib import Path
from typing import Literal

from ....errors import LibraryError
from ..found import FoundModel
from ..names import shown
from . import mjcf_format, mjcf_text, partnet, rigid, shapenet_sem, sweethome3d, urdf_format
from .files import ARCHIVES, Files, FolderFiles, ZipFiles, open_files
from .limits import ReadLimits
from .mesh_headers import MESH_ENDINGS
from .safe_xml import parse_xml
from .simplify import within_budget

FORMATS = "OBJ, GLB, glTF, STL, PLY, DAE, URDF, MJCF, PartNet-Mobility, ShapeNetSem and .sh3f"
ItemKind = Literal["mesh", "urdf", "mjcf", "partnet", "shapenet_sem", "sweethome3d", "refused"]
_LOOKS_LIKE_A_ROBOT = re.compile(rb"<\s*(mujoco|robot)\b")
_ROBOT_ENDINGS = (".urdf", ".xml", ".mjcf")
_LIMITS = ReadLimits()


@dataclasses.dataclass(frozen=True)
class Item:
    """One model, or one document of several, that was recognised but not read yet."""

    kind: ItemKind
    root: Path
    """The folder or archive that its files are in."""
    entry: str
    """Its file below the root."""
    source: str
    """For messages and records; the same wherever the root lies."""
    record: dict[str, str] = dataclasses.field(default_factory=dict)
    """What a table says of it; of a refused item, the ``problem`` and the ``hint``."""

    def read(self, limits: ReadLimits = _LIMITS) -> tuple[FoundModel, ...]:
        """The models, mostly one; raises `LibraryError` with the reason why there is none."""
        if self.kind == "refused":
            raise LibraryError(self.record["problem"], self.record["hint"])
        files = open_files(self.root, limits)
        found = _READERS[self.kind](files, self, limits)
        return tuple(_light(model, limits) for model in found)


def _light(found: FoundModel, limits: ReadLimits) -> FoundModel:
    robot, notes = within_budget(found.robot, limits)
    return dataclasses.replace(found, robot=robot, notes=(*found.notes, *notes))


_READERS: dict[ItemKind, Callable[[Files, Item, ReadLimits], tuple[FoundModel, ...]]] = {
    "mesh": lambda files, item, limits: (rigid.read_mesh_model(files, item.entry, limits),),
    "urdf": lambda files, item, limits: (urdf_format.read_urdf_model(files, item.entry, limits),),
    "mjcf": lambda files, item, limits: mjcf_format.read_mjcf_models(files, item.entry, limits),
    "partnet": lambda files, item, limits: (partnet.read_partnet(files, item.entry, limits),),
    "shapenet_sem": lambda files, item, limits: (
        shapenet_sem.read_row(files, item.entry, item.record, limits),
    ),
    "sweethome3d": lambda files, item, limits: (
        sweethome3d.read_entry(files, item.record, limits),
    ),
}


def find_models(path: Path | str, limits: ReadLimits = _LIMITS) -> list[Item]:
    """What a path holds, in the order of the files' names; nothing is read but tables.

    Meshes that a robot file uses, and documents that another includes, are no models of their
    own. What cannot be recognised without harm comes as an item whose ``read`` says why.

    Args:
        path: A folder, an archive (``.sh3f``, ``.zip``) or one file.
        limits: Bounds on what is opened.

    Raises:
        LibraryError: There is no such path, or no model in it.
    """
    root = Path(path)
    if not root.exists():
        raise LibraryError(f"no such file or folder: {root}", "give the path of what to add")
    if root.is_dir():
        files = FolderFiles(root, limits)
        items = _items(files, root, limits, files.names)
        for name in files.names:
            if name.lower().endswith(ARCHIVES):
                items += _archive_items(root / name, f"{files.label}/{name}", limits)
    elif root.name.lower().endswith(ARCHIVES):
        items = _archive_items(root, root.name, limits)
    else:
        items = _items(FolderFiles(root.parent, limits), root.parent, limits, (root.name,))
    if not items:
        raise LibraryError(f"{root} holds no models", f"these are read: {FORMATS}")
    return sorted(items, key=lambda item: (item.source, item.entry))


def _archive_items(path: Path, label: str, limits: ReadLimits) -> list[Item]:
    try:
        files = ZipFiles(path, path.name, limits)
    except LibraryError as error:
        return [_refused(path, "", shown(label), error)]
    refused = [
        _refused(path, name, f"{files.label}/{shown(name)}", _unread(files, name, reason))
        for name, reason in sorted(files.refused.items())
    ]
    return _items(files, path, limits, files.names) + refused


def _unread(files: Files, name: str, reason: str) -> LibraryError:
    problem = f"{shown(name)} of {files.label} is not read: {reason}"
    return LibraryError(problem, "pack the archive again")


def _refused(root: Path, entry: str, source: str, error: LibraryError) -> Item:
    return Item("refused", root, entry, source, {"problem": error.problem, "hint": error.hint})


def _items(files: Files, root: Path, limits: ReadLimits, names: tuple[str, ...]) -> list[Item]:
    """Items of one folder or archive; what an earlier kind uses is left out of later ones."""
    search = _Search(files, root, limits, names)
    search.catalogues()
    search.partnet()
    search.robots()
    search.shapenet()
    search.meshes()
    return search.items


class _Search:
    """Recognises one kind after the other."""

    def __init__(
        self, files: Files, root: Path, limits: ReadLimits, names: tuple[str, ...]
    ) -> None:
        self._files, self._root, self._limits, self._names = files, root, limits, names
        self._used: set[str] = set()
        self._owned: list[str] = []
        self.items: list[Item] = []

    def _add(self, kind: ItemKind, name: str, record: dict[str, str] | None = None) -> None:
        source = f"{self._files.label}/{shown(name)}"
        self.items.append(Item(kind, self._root, name, source, record or {}))

    def _refuse(self, name: str, error: LibraryError) -> None:
        source = f"{self._files.label}/{shown(name)}"
        self.items.append(_refused(self._root, name, source, error))

    def _ending(self, *endings: str) -> list[str]:
        """Files with such an ending that nothing else uses."""
        owned = tuple(self._owned)
        return [
            name
            for name in self._names
            if name.lower().endswith(endings)
            and name not in self._used
            and not name.startswith(owned)
        ]

    def catalogues(self) -> None:
        """A catalogue stands for all meshes of its archive or folder."""
        if sweethome3d.CATALOGUE not in self._names:
            return
        self._owned.append("")
        try:
            entries = sweethome3d.catalogue_entries(self._files)
        except LibraryError as error:
            return self._refuse(sweethome3d.CATALOGUE, error)
        for number, entry in enumerate(entries):
            name = sweethome3d.entry_name(entry)
            source = f"{self._files.label}/{shown(name)}"
            self.items.append(Item("sweethome3d", self._root, f"{number:06d}", source, entry))

    def partnet(self) -> None:
        for name in self._ending(partnet.URDF):
            folder = posixpath.dirname(name)
            if posixpath.basename(name) == partnet.URDF and self._files.has(
                posixpath.join(folder, partnet.SEMANTICS)
            ):
                self._add("partnet", name)
                self._owned.append(f"{folder}/" if folder else "")

    def robots(self) -> None:
        """URDF and MJCF by their root element; what they name is theirs."""
        documents: list[str] = []
        for name in self._ending(*_ROBOT_ENDINGS):
            tag = self._root_tag(name)
            if tag == "robot":
                self._add("urdf", name)
                self._used |= urdf_format.referenced_files(self._files, name, self._limits)
            elif tag in ("mujoco", "mujocoinclude"):
                self._used |= mjcf_text.included_files(self._files, name, self._limits)
                documents += [name] if tag == "mujoco" else []
        for name in documents:
            if name not in self._used:
                self._add("mjcf", name)

    def _root_tag(self, name: str) -> str | None:
        """None where a file is no robot; a bad one that means to be is refused."""
        try:
            content = self._files.read(name)
        except LibraryError as error:
            self._refuse(name, error)
            return None
        try:
            root = parse_xml(content, name, self._limits)
        except LibraryError as error:
            if name.lower().endswith(".urdf") or _LOOKS_LIKE_A_ROBOT.search(content):
                self._refuse(name, error)
            return None
        if name.lower().endswith(".urdf") and root.tag != "robot":
            problem = f"{shown(name)} is no URDF: its root is <{root.tag}>"
            self._refuse(name, LibraryError(problem, "give it the ending of its format"))
            return None
        return root.tag

    def shapenet(self) -> None:
        for name in self._ending(".csv"):
            try:
                rows = shapenet_sem.metadata_rows(self._files, name)
            except LibraryError as error:
                self._refuse(name, error)
                continue
            if rows is None:
                continue
            for mesh, row in shapenet_sem.described_meshes(self._files, rows).items():
                if mesh not in self._used:
                    self._used.add(mesh)
                    self._add("shapenet_sem", mesh, row)

    def meshes(self) -> None:
        for name in self._ending(*MESH_ENDINGS):
            self._add("mesh", name)
