"""What a library of CAD models is: the models, and their boxes and planes as padded arrays."""

from .arrays import MAX_MODEL_PLANES, LibraryArrays, library_arrays
from .cad_models import CadLibrary, CadModel, Collision, Handle, HullMaker, held

__all__ = [
    "MAX_MODEL_PLANES",
    "CadLibrary",
    "CadModel",
    "Collision",
    "Handle",
    "HullMaker",
    "LibraryArrays",
    "held",
    "library_arrays",
]
