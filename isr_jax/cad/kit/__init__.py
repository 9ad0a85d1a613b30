"""CAD models by code: each a function of a few named dimensions that returns a `ModelBuilder`.

The makers stand in the modules of this package, one per kind of thing; `KIT` names what the
default library holds, `make` builds one of it, `fit_cad` makes it at another size.
"""

from .builder import ModelBuilder
from .catalogue import KIT, make
from .fitting import FIT_RANGE, fit_cad
from .furniture.fronts import Column, Front, Look, columns_of
from .materials import Material
from .rows import Row, row

__all__ = [
    "FIT_RANGE",
    "KIT",
    "Column",
    "Front",
    "Look",
    "Material",
    "ModelBuilder",
    "Row",
    "columns_of",
    "fit_cad",
    "make",
    "row",
]
