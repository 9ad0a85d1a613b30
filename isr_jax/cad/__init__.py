"""CAD models of furniture and household things: the kit that makes them, and their folder."""

from .kit import fit_cad
from .library import build_library, default_library, library_of, load_library, open_library
from .model_files import load_model, model_files, save_model
from .records import validate_record

VERSION: int = 2
"""Raised when the models or their format change."""

__all__ = [
    "VERSION",
    "build_library",
    "default_library",
    "fit_cad",
    "library_of",
    "load_library",
    "load_model",
    "model_files",
    "open_library",
    "save_model",
    "validate_record",
]
