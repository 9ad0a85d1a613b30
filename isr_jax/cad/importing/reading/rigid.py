"""Models of one mesh file: one rigid link."""

from __future__ import annotations

import posixpath

import numpy as np

from ....robot_model import Link, RobotModel
from ..found import FoundModel
from ..names import Unique, fit_name, is_generic, shown
from .files import Files
from .limits import ReadLimits
from .mesh_parts import Shape, as_visuals
from .mesh_shapes import read_shape

ROOT_LINK = "base"


def rigid_robot(shape: Shape, name: str) -> RobotModel:
    """One link with all parts; hulls, mass and joints are not stated by a mesh file."""
    visuals = as_visuals(shape.parts, Unique(), ROOT_LINK)
    link = Link(ROOT_LINK, visuals, (), 0.0, np.zeros(3), np.zeros((3, 3)))
    return RobotModel(fit_name(name, "model"), (link,), ())


def read_mesh_model(files: Files, name: str, limits: ReadLimits) -> FoundModel:
    """The model of one mesh file; raises `LibraryError`."""
    shape = read_shape(files, name, limits)
    called = model_name(name)
    return FoundModel(
        name=called,
        source=source_of(files, name),
        robot=rigid_robot(shape, called),
        unit_m=shape.unit_m,
        up=shape.up,
        front=shape.front,
        tags=folder_tags(files, name),
        licence=shape.licence,
        creator=shape.creator,
        notes=shape.notes,
    )


def source_of(files: Files, name: str) -> str:
    """What a model's record says of where it came from; the same wherever the folder lies."""
    return f"{files.label}/{shown(name)}"


def model_name(name: str) -> str:
    """What the model of a file is called: its stem, or its folder where that says more."""
    stem = posixpath.splitext(posixpath.basename(name))[0]
    folder = posixpath.basename(posixpath.dirname(name))
    says_more = is_generic(stem) or folder.lower().startswith(stem.lower())
    return shown(folder if folder and says_more else stem)


def folder_tags(files: Files, name: str) -> tuple[str, ...]:
    """What a class may be guessed from: the file's name, then its folders, nearest first."""
    stem = posixpath.splitext(posixpath.basename(name))[0]
    folders = posixpath.dirname(name).split("/")[::-1]
    words = [stem, *folders, files.label]
    return tuple(dict.fromkeys(shown(word) for word in words if word))
