"""Java's ``.properties`` files: Latin-1 text of ``key=value`` lines with backslash escapes."""

from __future__ import annotations

import re

_ESCAPE = re.compile(r"\\(u[0-9A-Fa-f]{4}|.)", re.DOTALL)
_PLAIN = {"t": "\t", "n": "\n", "r": "\r", "f": "\f"}
_KEY = re.compile(r"((?:\\.|[^\\=:\s])*)\s*[=:\s]?\s*(.*)", re.DOTALL)


def read_properties(content: bytes) -> dict[str, str]:
    """Values by key; of equal keys the last counts."""
    found: dict[str, str] = {}
    for line in _logical_lines(content.decode("latin-1")):
        match = _KEY.fullmatch(line)
        if match is not None and match[1]:
            found[_unescaped(match[1])] = _unescaped(match[2]).rstrip()
    return found


def _logical_lines(text: str):
    """Lines without comments; those that end in a backslash go on in the next."""
    held = ""
    for line in re.split(r"\r\n|\r|\n", text):
        line = line.lstrip()
        if not held and (not line or line[0] in "#!"):
            continue
        held += line
        backslashes = len(held) - len(held.rstrip("\\"))
        if backslashes % 2:
            held = held[:-1]
        else:
            yield held
            held = ""
    if held:
        yield held


def _unescaped(text: str) -> str:
    return _ESCAPE.sub(lambda m: _character(m[1]), text)


def _character(code: str) -> str:
    if len(code) == 5:
        return chr(int(code[1:], 16))
    return _PLAIN.get(code, code)
