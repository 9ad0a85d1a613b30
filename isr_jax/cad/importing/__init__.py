"""Foreign CAD models: read, checked, converted, and added to a library."""

from .add import AddOptions, add_models
from .add_report import Added, AddReport, Rejected, report_tables
from .converting.convert import convert
from .converting.settings import ConvertSettings
from .found import FoundModel
from .reading.limits import ReadLimits
from .reading.sources import Item, find_models

__all__ = [
    "AddOptions",
    "AddReport",
    "Added",
    "ConvertSettings",
    "FoundModel",
    "Item",
    "ReadLimits",
    "Rejected",
    "add_models",
    "convert",
    "find_models",
    "report_tables",
]
