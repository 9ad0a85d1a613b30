"""Border: the files of one folder or archive, and nothing outside it.

Every reader gets its bytes here. Names are relative, with forward slashes; a name that leads out
of the folder, a link that does, a file that is too large, and an archive's file that unpacks to
far more than it is, are refused.
"""

from __future__ import annotations

import io
import os
import posixpath
import re
import stat
import zipfile
from pathlib import Path
from typing import Protocol, runtime_checkable

from ....errors import LibraryError
from ..names import shown
from .limits import ReadLimits

_DRIVE = re.compile(r"^[A-Za-z]:")
_SMALL_BYTES = 1_000_000  # up to here a high ratio is harmless: blank images and tables
ARCHIVES = (".sh3f", ".zip")


@runtime_checkable
class Files(Protocol):
    """Files below one root."""

    @property
    def label(self) -> str:
        """The root's name, for messages."""
        ...

    @property
    def names(self) -> tuple[str, ...]:
        """Of all files, sorted."""
        ...

    @property
    def refused(self) -> dict[str, str]:
        """Files that are never read, each with its reason."""
        ...

    def has(self, name: str) -> bool:
        """Whether there is such a file."""
        ...

    def beside(self, folder: str) -> tuple[str, ...]:
        """Names of the files in one folder."""
        ...

    def read(self, name: str) -> bytes:
        """The content; raises `LibraryError` where there is none or it is refused."""
        ...


class FolderFiles:
    """Files of a folder on disk."""

    def __init__(self, root: Path, limits: ReadLimits) -> None:
        self._root, self._limits = root, limits
        self.label = shown(root.resolve().name)
        self.refused: dict[str, str] = {}
        self._names: tuple[str, ...] | None = None

    @property
    def names(self) -> tuple[str, ...]:
        if self._names is None:
            self._names = tuple(sorted(self._walk()))
        return self._names

    def _walk(self):
        for folder, folders, files in os.walk(self._root):
            folders[:] = [name for name in folders if not name.startswith(".")]
            for name in files:
                if not name.startswith("."):
                    yield (Path(folder) / name).relative_to(self._root).as_posix()

    def has(self, name: str) -> bool:
        return (self._root / name).is_file()

    def beside(self, folder: str) -> tuple[str, ...]:
        try:
            found = sorted(os.listdir(self._root / folder))
        except OSError:
            return ()
        return tuple(posixpath.join(folder, name) for name in found)

    def read(self, name: str) -> bytes:
        """Content of a file; raises `LibraryError` where it is outside, too large or unreadable."""
        path = self._root / within("", name)
        if not path.resolve().is_relative_to(self._root.resolve()):
            problem = f"{shown(name)} is a link to outside of {self.label}"
            raise LibraryError(problem, "put the file itself into the folder")
        try:
            # Without O_NONBLOCK a named pipe would be waited for, for ever.
            with open(os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0)), "rb") as file:
                info = os.fstat(file.fileno())
                if not stat.S_ISREG(info.st_mode):
                    raise LibraryError(f"{shown(name)} is no plain file", "give a file")
                check_size(name, info.st_size, self._limits)
                return file.read()
        except OSError as error:
            raise LibraryError(f"{shown(name)}: {error.strerror}", "restore the file") from None


class ZipFiles:
    """Files of a ZIP archive, which is never unpacked to disk.

    Raises:
        LibraryError: It is no ZIP, or holds too many files.
    """

    def __init__(self, source: Path | bytes, label: str, limits: ReadLimits) -> None:
        self.label, self._limits = shown(label), limits
        hint = "download it again, or give the folder that was packed"
        try:
            self._zip = zipfile.ZipFile(source if isinstance(source, Path) else io.BytesIO(source))
        except (OSError, zipfile.BadZipFile, NotImplementedError, ValueError) as error:
            raise LibraryError(f"{self.label} is no ZIP that can be read: {error}", hint) from None
        entries = [entry for entry in self._zip.infolist() if not entry.is_dir()]
        if len(entries) > limits.max_archive_files:
            problem = f"{self.label} holds {len(entries)} files, above {limits.max_archive_files}"
            raise LibraryError(problem, "raise max_archive_files, or give fewer files")
        self.refused: dict[str, str] = {}
        self._entries: dict[str, zipfile.ZipInfo] = {}
        for entry in entries:
            reason = _unsafe(entry)
            name = entry.filename
            if reason is None and name in self._entries:
                reason = "its name occurs twice in the archive"
            if reason is None:
                self._entries[name] = entry
            else:
                self.refused[name] = reason
                self._entries.pop(name, None)
        self.names = tuple(sorted(self._entries))

    def has(self, name: str) -> bool:
        return name in self._entries

    def beside(self, folder: str) -> tuple[str, ...]:
        return tuple(name for name in self.names if posixpath.dirname(name) == folder)

    def read(self, name: str) -> bytes:
        """Content of a file; raises `LibraryError` where it is missing, too large or damaged."""
        entry = self._entries.get(within("", name))
        if entry is None:
            problem = f"{self.label} holds no {shown(name)}"
            raise LibraryError(problem, "pack the archive again with all its files")
        check_size(name, entry.file_size, self._limits)
        ratio = entry.file_size / max(entry.compress_size, 1)
        if entry.file_size > _SMALL_BYTES and ratio > self._limits.max_archive_ratio:
            problem = f"{shown(name)} unpacks to {ratio:.0f} times its size"
            raise LibraryError(problem, "raise max_archive_ratio if it is meant to")
        try:
            # Reads no more than the size that the archive's table declares, which was checked.
            return self._zip.read(entry)
        except (OSError, zipfile.BadZipFile, NotImplementedError, RuntimeError, EOFError) as error:
            problem = f"{shown(name)} of {self.label} cannot be unpacked: {error}"
            raise LibraryError(problem, "download the archive again") from None
        except Exception as error:  # zlib, lzma and bz2 have errors of their own
            problem = f"{shown(name)} of {self.label} is damaged: {error}"
            raise LibraryError(problem, "download the archive again") from None


def _unsafe(entry: zipfile.ZipInfo) -> str | None:
    # `orig_filename` still has what `filename` was normalised from: separators, null bytes.
    name = entry.orig_filename.replace("\\", "/")
    if name.startswith("//") or _DRIVE.match(name) or ".." in name.split("/") or "\0" in name:
        return "its name leads out of the archive"
    if name.startswith("/"):
        return "its name is absolute"
    if stat.S_ISLNK(entry.external_attr >> 16):
        return "it is a link"
    return "it is encrypted" if entry.flag_bits & 1 else None


def open_files(path: Path, limits: ReadLimits) -> Files:
    """The files of a folder or archive."""
    if path.is_dir():
        return FolderFiles(path, limits)
    return ZipFiles(path, path.name, limits)


def check_size(name: str, size_bytes: int, limits: ReadLimits) -> None:
    """Refuse a file that is too large to be read.

    Raises:
        LibraryError: It is larger than ``limits`` allow.
    """
    if size_bytes > limits.max_file_mb * 1e6:
        problem = f"{shown(name)} has {size_bytes / 1e6:.0f} MB, above {limits.max_file_mb:g}"
        raise LibraryError(problem, "raise max_file_mb if it is meant to be so large")


def within(folder: str, reference: str, root: str = "") -> str:
    """Name below the root of what a file in ``folder`` refers to; refuses what leads out of it.

    Args:
        folder: Of the file that refers, below the root.
        reference: As the file has it.
        root: The root folder's own name: out of it and into it again is inside.

    Raises:
        LibraryError: It leads out of the root.
    """
    name = posixpath.normpath(posixpath.join(folder, reference.replace("\\", "/")))
    if root and name.startswith(f"../{root}/"):
        name = name.removeprefix(f"../{root}/")
    if name == ".." or name.startswith(("../", "/")) or _DRIVE.match(name):
        problem = f"reference {shown(reference)!r} leads out of the given folder"
        raise LibraryError(problem, "give the folder that holds both files, or copy the file in")
    return "" if name == "." else name


def locate(files: Files, folder: str, reference: str) -> str | None:
    """Name of the file that is referred to, None where there is none.

    Letter case, and letters beyond ASCII in an unknown encoding, are no obstacle. Absolute paths
    are those of the machine where the file was written: only their last part is looked for,
    beside the file that refers.
    """
    plain = shown(reference).strip().replace("\\", "/")
    if plain.startswith("/") or _DRIVE.match(plain):
        plain = posixpath.basename(plain)
    wanted = within(folder, plain, files.label)
    if not posixpath.basename(wanted):
        return None
    if files.has(wanted):
        return wanted
    around = files.beside(posixpath.dirname(wanted))
    same = [name for name in around if _folded(name) == _folded(wanted)]
    return same[0] if len(same) == 1 and files.has(same[0]) else None


def _folded(name: str) -> str:
    return re.sub(r"[^\x00-\x7f]+", "?", name.lower())
