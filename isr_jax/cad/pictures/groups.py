"""Which classes share a contact sheet."""

from __future__ import annotations

from collections.abc import Sequence

from ...library import CadModel

GROUPS: dict[str, tuple[str, ...]] = {
    "chairs": ("chair", "stool", "bench"),
    "sofas_and_beds": ("sofa", "bed", "cushion"),
    "tables": ("table", "desk", "counter"),
    "cabinets": ("cabinet", "drawer_unit", "nightstand"),
    "wardrobes_and_shelves": ("wardrobe", "wall_cabinet", "bookshelf"),
    "kitchen": ("fridge", "microwave", "oven", "dishwasher", "washing_machine", "kettle"),
    "bath_and_doors": ("sink", "toilet", "bathtub", "door", "window"),
    "devices": ("monitor", "laptop", "keyboard", "lamp", "mouse", "remote", "phone", "clock"),
    "things": ("plant", "bin", "box", "bag", "cup", "bowl", "bottle", "book", "vase"),
}
"""A sheet each; its name is part of the file's."""
REST = "other"


def grouped(models: Sequence[CadModel]) -> dict[str, list[CadModel]]:
    """Models by sheet, in the order of `GROUPS`; sheets without models are left out."""
    sheet = {name: group for group, names in GROUPS.items() for name in names}
    found: dict[str, list[CadModel]] = {group: [] for group in (*GROUPS, REST)}
    for model in models:
        found[sheet.get(model.class_name, REST)].append(model)
    return {group: members for group, members in found.items() if members}
