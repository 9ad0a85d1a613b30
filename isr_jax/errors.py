"""Errors that say what is wrong, where, and what would do.

Everything a user can cause is an `IsrError`; `cli.py` prints it as one message and exits with 2.
"""

from __future__ import annotations


class IsrError(Exception):
    """Base of all errors of this package.

    Args:
        problem: What is wrong: the file, the value, the bound.
        hint: The way out, as an instruction.
    """

    def __init__(self, problem: str, hint: str = "") -> None:
        self.problem = problem
        self.hint = hint
        super().__init__(f"{problem}\n  -> {hint}" if hint else problem)


class SequenceError(IsrError):
    """A sequence that cannot be opened: no frames, no intrinsics, unknown layout."""


class FrameError(IsrError):
    """One frame that cannot be read; the others can. It is skipped, counted and reported."""


class SegmenterError(IsrError):
    """A segmenter that cannot be loaded or whose outputs are not what its sidecar says."""


class LibraryError(IsrError):
    """A CAD library or one of its models that cannot be used."""


class ClassError(IsrError):
    """A class name or id that the table of classes does not hold."""


class SettingError(IsrError):
    """A setting out of its bounds, or one that differs from a stored result."""


class OutputError(IsrError):
    """An output folder that cannot be written or read back."""


class MapError(IsrError):
    """A map that ran out of its stated capacity, or a saved map that cannot be read."""


class SceneError(IsrError):
    """A scene.json, MJCF or URDF that cannot be read or does not follow its schema."""
