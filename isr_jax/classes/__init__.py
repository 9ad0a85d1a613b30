"""The one table of classes (``classes.csv``), and the label lists of foreign data sets."""

from .label_lists import LABEL_SETS, Label, label_list
from .numbering import number_by_class
from .table import ClassInfo, ClassKind, Mount, class_named, classes, label_table

__all__ = [
    "LABEL_SETS",
    "ClassInfo",
    "ClassKind",
    "Label",
    "Mount",
    "class_named",
    "classes",
    "label_list",
    "label_table",
    "number_by_class",
]
