"""Names of foreign files and parts, made fit for links, joints, files and folders."""

from __future__ import annotations

import os
import re
import unicodedata

_UNFIT = re.compile(r"[^A-Za-z0-9_.\-]+")
_MAX_LENGTH = 60
_GENERIC = {"base_link", "default", "mesh", "mobility", "model", "models", "object", "scene"}
_GENERIC |= {"textured", "untitled", "visual"}


def shown(name: str) -> str:
    """A file name for messages: bytes that are no UTF-8 are taken as Latin-1."""
    try:
        name.encode()
    except UnicodeEncodeError:
        return os.fsencode(name).decode("latin-1")
    return name


def fit_name(name: str, otherwise: str) -> str:
    """Letters, digits and ``_ . -`` alone, at most 60; ``otherwise`` where nothing is left."""
    plain = unicodedata.normalize("NFKD", shown(name))
    plain = "".join(c for c in plain if not unicodedata.combining(c))
    return _UNFIT.sub("_", plain).strip("_.-")[:_MAX_LENGTH].strip("_.-") or otherwise


def slug(name: str, otherwise: str = "model") -> str:
    """A folder name: lower case words joined by underscores."""
    words = re.sub(r"([a-z0-9])([A-Z])", r"\1_\2", fit_name(name, otherwise))
    return re.sub(r"[_.\-]+", "_", words).strip("_").lower() or otherwise


def is_generic(name: str) -> bool:
    """A file name that says nothing about what is in it."""
    return slug(name) in _GENERIC


class Unique:
    """Hands out names that differ, also where letter case does not count."""

    def __init__(self) -> None:
        self._taken: set[str] = set()

    def __call__(self, name: str) -> str:
        found, number = name, 2
        while found.lower() in self._taken:
            found, number = f"{name}_{number}", number + 1
        self._taken.add(found.lower())
        return found
