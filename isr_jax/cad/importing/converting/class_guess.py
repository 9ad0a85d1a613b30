"""From the words that name a model to a row of the table of classes.

A name is read as English compounds are: up to the first "with", "for", comma or bracket, and its
last word says what the thing is ("bedside table", "toilet brush"). The table of words knows heads
that are no class of ours too ("brush"), so that a toilet brush does not become a toilet.
"""

from __future__ import annotations

import dataclasses
import functools
import re
from collections.abc import Sequence

from .class_words import OTHER, WORDS

_STOPS = frozenset(
    [
        "with",
        "for",
        "and",
        "in",
        "on",
        "of",
        "from",
        "by",
        "without",
        "from",
        "under",
        "at",
        "to",
        ",",
        "(",
        "-",
        "/",
    ]
)


@dataclasses.dataclass(frozen=True)
class ClassGuess:
    """What a model's words say it is."""

    class_name: str
    words: str
    """The text it was taken from; empty where nothing was known."""


@functools.cache
def _phrases() -> dict[tuple[str, ...], str]:
    """Classes by phrase, its words in the singular."""
    table: dict[tuple[str, ...], str] = {}
    for class_name, listed in WORDS.items():
        for phrase in listed.split(", "):
            table.setdefault(tuple(words_of(phrase)), class_name)
    return table


_LONGEST = 6
"""Words in a phrase."""
_LEAST_ENDING = 5
"""Letters: "cabinet" ends compounds, "bin" ends too much else."""


def _singular(word: str) -> str:
    irregular = {"shelves": "shelf", "knives": "knife", "glasses": "glasses", "bus": "bus"}
    if word in irregular:
        return irregular[word]
    if word.endswith(("sses", "shes", "ches", "xes")):
        return word[:-2]
    return word[:-1] if len(word) > 3 and word.endswith("s") and word[-2] not in "su" else word


def words_of(text: str) -> list[str]:
    """Words and stops of a name in the singular: ``StorageFurniture_12`` gives storage, furniture.

    Numbers stay only between words, where a table of names may know them ("sofa 2 seats").
    """
    parted = re.sub(r"(?<=[a-z])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])", " ", text)
    parted = re.sub(r"(?<=[A-Za-z])(?=\d)", " ", parted).replace("'s ", " ")
    words = re.findall(r"[a-z]+|\d+|,|\(|/", parted.replace("-", " ").lower())
    while words and words[-1].isdigit():
        words.pop()
    return [_singular(word) for word in words]


def class_of_words(text: str) -> str | None:
    """The class whose name ends the text (its head), longest phrase first; None if unknown."""
    words = words_of(text)
    table = _phrases()
    for end in dict.fromkeys([len(words), _head_end(words)]):
        for start in range(max(0, end - _LONGEST), end):
            found = table.get(tuple(words[start:end]))
            if found is not None:
                return found
    return None


def _class_at_end(text: str) -> str | None:
    """The class whose name the last word ends with: ``slidecabinet``."""
    words = words_of(text)
    ends = [p[0] for p in _phrases() if len(p) == 1 and len(p[0]) >= _LEAST_ENDING]
    fits = [end for end in ends if words and words[-1].endswith(end)]
    return _phrases()[(max(fits, key=len),)] if fits else None


def _head_end(words: list[str]) -> int:
    stops = [i for i, word in enumerate(words) if i > 0 and word in _STOPS]
    return stops[0] if stops else len(words)


def _class_within(text: str) -> str | None:
    """The class of the longest known phrase anywhere in the text, the last of equals."""
    words, table = words_of(text), _phrases()
    for length in range(min(_LONGEST, len(words)), 0, -1):
        for start in range(len(words) - length, -1, -1):
            found = table.get(tuple(words[start : start + length]))
            if found is not None:
                return found
    return None


def guess_class(texts: Sequence[str]) -> ClassGuess:
    """The class that the best of some texts names; `OTHER` where none does.

    Heads of all texts come before words inside them.

    Args:
        texts: Name, categories, keywords, folder names: the most telling first.
    """
    for reading in (class_of_words, _class_within, _class_at_end):
        for text in texts:
            found = reading(text)
            if found is not None:
                return ClassGuess(found, text)
    return ClassGuess(OTHER, "")
