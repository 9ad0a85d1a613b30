"""What annotators of scans call things, in our classes.

A name is looked up as one of ours, then as NYU40's, then among what SceneNN's free text and the
released code of the paper say (its Backpack and Bag are one class, Couch is a sofa). Unknown names
are None: the caller says which they were.
"""

from __future__ import annotations

import functools
import re

from ..classes import classes, label_table

NYU40_NAMES = (
    "wall", "floor", "cabinet", "bed", "chair", "sofa", "table", "door", "window", "bookshelf",
    "picture", "counter", "blinds", "desk", "shelves", "curtain", "dresser", "pillow", "mirror",
    "floor mat", "clothes", "ceiling", "books", "refridgerator", "television", "paper", "towel",
    "shower curtain", "box", "whiteboard", "person", "night stand", "toilet", "sink", "lamp",
    "bathtub", "bag", "otherstructure", "otherfurniture", "otherprop",
)  # fmt: skip
"""Ids 1 to 40 (Gupta et al., "Perceptual Organization and Recognition of Indoor Scenes", 2013)."""

_SAME = {
    "backpack": "bag", "handbag": "bag", "suitcase": "bag", "luggage": "bag", "purse": "bag",
    "couch": "sofa", "loveseat": "sofa",
    "armchair": "chair", "office chair": "chair", "swivel chair": "chair",
    "coffee table": "table", "dining table": "table", "end table": "table",
    "side table": "table", "teapoy": "table",
    "tv": "monitor", "computer monitor": "monitor", "tv monitor": "monitor",
    "fridge": "fridge", "refrigerator": "fridge", "mini fridge": "fridge",
    "shelf": "bookshelf", "book shelf": "bookshelf", "bookcase": "bookshelf",
    "cupboard": "cabinet", "kitchen cabinet": "cabinet", "file cabinet": "cabinet",
    "drawer": "drawer_unit", "drawers": "drawer_unit", "chest of drawers": "drawer_unit",
    "closet": "wardrobe", "bedside table": "nightstand",
    "trash bin": "bin", "trash can": "bin", "rubbish bin": "bin", "dustbin": "bin",
    "recycling bin": "bin", "garbage bin": "bin", "wastebasket": "bin",
    "mug": "cup", "cushion": "cushion", "carpet": "rug", "mat": "rug", "desk lamp": "lamp",
    "table lamp": "lamp", "floor lamp": "lamp", "plant pot": "plant",
    "potted plant": "plant", "flower": "plant", "notebook": "book", "telephone": "phone",
    "cellphone": "phone", "poster": "picture", "painting": "picture", "photo": "picture",
    "photo frame": "picture", "white board": "picture",
    "washing machine": "washing_machine", "laundry machine": "washing_machine",
    "kitchen counter": "counter", "bathroom counter": "counter", "people": "person",
    "bath tub": "bathtub", "carton": "box", "cardboard box": "box", "tissue box": "box",
    "stair": "stairs", "staircase": "stairs", "doorframe": "door", "door frame": "door",
}  # fmt: skip


@functools.cache
def _by_name() -> dict[str, str]:
    table, rows = label_table("nyu40"), classes()
    nyu = {
        name: rows[int(table[i])].name
        for i, name in enumerate(NYU40_NAMES, 1)
        if i < len(table) and table[i]
    }
    ours = {row.name.replace("_", " "): row.name for row in rows if row.kind != "none"}
    return nyu | _SAME | ours


def class_of_name(text: str) -> str | None:
    """Our class of an annotator's name, however spaced, numbered or cased; None if unknown.

    A number at the end tells instances apart (``chair 2``); a plural is its singular.
    """
    name = re.sub(r"[\s_\-]+", " ", text.strip().lower())
    name = re.sub(r" ?\d+$", "", name)
    table = _by_name()
    return next((table[n] for n in (name, name.removesuffix("s")) if n in table), None)


def class_of_nyu40(id: int) -> str | None:
    """Our class of a NYU40 id; None for those that none of ours stands for."""
    table = label_table("nyu40")
    found = int(table[id]) if 0 < id < len(table) else 0
    return classes()[found].name if found else None
