"""What annotators of scans call things, in our classes.

A name is looked up as one of ours, then as NYU40's, then among what SceneNN's free text and the
released code of the paper say (its Backpack and Bag are one class, Couch is a sofa). Unknown names
are None: the caller says which they were.
"""

from __future__ import annotations

import functools
import re

from ..classes import classes, label_table

_NYU40 = (
    "wall, floor, cabinet, bed, chair, sofa, table, door, window, bookshelf, picture, "
    "counter, blinds, desk, shelves, curtain, dresser, pillow, mirror, floor mat, clothes, "
    "ceiling, books, refridgerator, television, paper, towel, shower curtain, box, "
    "whiteboard, person, night stand, toilet, sink, lamp, bathtub, bag, otherstructure, "
    "otherfurniture, otherprop"
)
NYU40_NAMES = tuple(_NYU40.split(", "))
"""Ids 1 to 40 (Gupta et al., "Perceptual Organization and Recognition of Indoor Scenes", 2013)."""

_SAID = {
    "bag": "backpack, handbag, suitcase, luggage, purse",
    "sofa": "couch, loveseat",
    "chair": "armchair, office chair, swivel chair",
    "table": "coffee table, dining table, end table, side table, teapoy",
    "monitor": "tv, computer monitor, tv monitor",
    "fridge": "fridge, refrigerator, mini fridge",
    "bookshelf": "shelf, book shelf, bookcase",
    "cabinet": "cupboard, kitchen cabinet, file cabinet",
    "drawer_unit": "drawer, drawers, chest of drawers",
    "wardrobe": "closet",
    "nightstand": "bedside table",
    "bin": "trash bin, trash can, rubbish bin, dustbin, recycling bin, garbage bin, wastebasket",
    "cup": "mug",
    "cushion": "cushion",
    "rug": "carpet, mat",
    "lamp": "desk lamp, table lamp, floor lamp",
    "plant": "plant pot, potted plant, flower",
    "book": "notebook",
    "phone": "telephone, cellphone",
    "picture": "poster, painting, photo, photo frame, white board",
    "washing_machine": "washing machine, laundry machine",
    "counter": "kitchen counter, bathroom counter",
    "person": "people",
    "bathtub": "bath tub",
    "box": "carton, cardboard box, tissue box",
    "stairs": "stair, staircase",
    "door": "doorframe, door frame",
}
"""What annotators say for each of our classes."""
_SAME = {said: name for name, list_of in _SAID.items() for said in list_of.split(", ")}


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
