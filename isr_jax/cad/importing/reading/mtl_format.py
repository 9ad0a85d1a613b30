"""Wavefront MTL: the colours and textures of an OBJ's materials."""

from __future__ import annotations

import dataclasses

from .mesh_parts import GREY

_OPTIONS = {"-o": 3, "-s": 3, "-t": 3, "-mm": 2, "-texres": 1, "-bm": 1, "-boost": 1}
_WORD_OPTIONS = {"-blendu": 1, "-blendv": 1, "-clamp": 1, "-cc": 1, "-imfchan": 1, "-type": 1}


@dataclasses.dataclass(frozen=True)
class MtlMaterial:
    """One material."""

    rgba: tuple[float, float, float, float] = GREY
    image: str | None = None
    """File of its colour texture, as the MTL names it."""


def read_mtl(text: str) -> dict[str, MtlMaterial]:
    """Materials by name; what cannot be understood of one is as if it were not there."""
    found: dict[str, MtlMaterial] = {}
    name = None
    for line in text.splitlines():
        head, _, rest = line.strip().replace("\t", " ").partition(" ")
        if head == "newmtl":
            name = rest.strip()
            found[name] = MtlMaterial()
        elif name is not None:
            found[name] = _with(found[name], head, rest)
    return found


def _with(material: MtlMaterial, head: str, rest: str) -> MtlMaterial:
    red, green, blue, alpha = material.rgba
    if head == "map_Kd":
        return dataclasses.replace(material, image=_file_name(rest) or material.image)
    if head not in ("Kd", "d", "Tr"):
        return material
    values = _numbers(rest)
    if head == "Kd" and values:
        red, green, blue = (values * 3)[:3] if len(values) < 3 else values[:3]
    elif head == "d" and values:
        alpha = values[-1]
    elif head == "Tr" and values:
        alpha = 1.0 - values[0]
    return dataclasses.replace(material, rgba=(red, green, blue, alpha))


def _numbers(text: str) -> list[float]:
    """The numbers of a line, each within [0, 1]."""
    values = []
    for word in text.split():
        try:
            value = float(word)
        except ValueError:
            continue
        if value == value:
            values.append(min(max(value, 0.0), 1.0))
    return values


def _file_name(rest: str) -> str:
    """What is left of a texture's line behind its options; names may hold spaces."""
    words = rest.split()
    while words and words[0].lower() in _OPTIONS | _WORD_OPTIONS:
        option = words.pop(0).lower()
        count = (_OPTIONS | _WORD_OPTIONS)[option]
        while count and len(words) > 1 and (option in _WORD_OPTIONS or _is_number(words[0])):
            words.pop(0)
            count -= 1
    return rest[_at(rest, words) :].strip()


def _at(rest: str, words: list[str]) -> int:
    """Where the first of the last words begins."""
    end = len(rest.rstrip())
    for word in reversed(words):
        end = rest.rindex(word, 0, end)
    return end


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True
