"""What furnishes a room, by role: a class, and the sizes and mounts that are plausible for it.

A library may come with a chair three metres high, or call a parasol a lamp: what fits no role is
not used. Sizes are those of furniture catalogues with some room around them, metres.
"""

from __future__ import annotations

import dataclasses

Range = tuple[float, float]

_HANGS = r"ceiling|hanging|pendant|chandelier|suspended"
_STANDING = ("floor", "surface")


@dataclasses.dataclass(frozen=True)
class Role:
    """Which models may play a part in a room."""

    class_names: tuple[str, ...]
    width_m: Range
    """Along the model's x."""
    depth_m: Range
    """Along its y, front to back."""
    height_m: Range
    mounts: tuple[str, ...] = ("floor",)
    top_m2: float = 0.0
    """Least area of the plane on which things are put; 0: it need not carry anything."""
    named: str = ""
    """Regular expression that the model's name must hold."""
    unnamed: str = ""
    """Regular expression that it must not hold."""


ROLES: dict[str, Role] = {
    # Kitchens
    "fridge": Role(("fridge",), (0.5, 0.95), (0.5, 0.85), (1.2, 2.1)),
    "worktop": Role(("counter",), (0.55, 1.85), (0.5, 0.75), (0.8, 1.0), top_m2=0.2),
    "base cabinet": Role(
        ("cabinet", "drawer_unit"), (0.35, 1.1), (0.5, 0.72), (0.78, 0.95), top_m2=0.12
    ),
    "cooker": Role(("oven",), (0.5, 1.05), (0.5, 0.75), (0.78, 0.95)),
    "dishwasher": Role(("dishwasher",), (0.4, 0.65), (0.5, 0.7), (0.75, 0.95)),
    "washing machine": Role(("washing_machine",), (0.4, 0.7), (0.4, 0.7), (0.75, 0.95)),
    "kitchen sink": Role(("sink",), (0.45, 1.1), (0.4, 0.65), (0.85, 1.15), _STANDING),
    "basin": Role(("sink",), (0.3, 0.6), (0.25, 0.45), (0.08, 0.2), _STANDING),
    "wall cabinet": Role(("wall_cabinet",), (0.3, 1.1), (0.18, 0.42), (0.35, 0.95), ("wall",)),
    "microwave": Role(("microwave",), (0.35, 0.6), (0.25, 0.5), (0.2, 0.4), _STANDING),
    "small oven": Role(("oven",), (0.35, 0.6), (0.3, 0.5), (0.2, 0.4), _STANDING),
    "hot plate": Role(("oven",), (0.25, 0.6), (0.25, 0.65), (0.04, 0.12), _STANDING),
    "kettle": Role(("kettle",), (0.1, 0.35), (0.08, 0.3), (0.12, 0.32), _STANDING),
    # Tables and seats
    "dining table": Role(("table",), (0.74, 1.9), (0.64, 1.15), (0.68, 0.8), top_m2=0.35),
    "meeting table": Role(("table",), (1.35, 2.5), (0.7, 1.3), (0.68, 0.8), top_m2=0.8),
    "low table": Role(("table",), (0.5, 1.3), (0.4, 0.85), (0.3, 0.56), top_m2=0.15),
    "side table": Role(("table",), (0.3, 0.62), (0.3, 0.62), (0.4, 0.66), top_m2=0.06),
    "desk": Role(("desk",), (0.95, 1.9), (0.5, 0.95), (0.66, 0.82), top_m2=0.3),
    "dining chair": Role(("chair",), (0.36, 0.62), (0.36, 0.66), (0.7, 1.1)),
    "office chair": Role(
        ("chair",), (0.54, 0.72), (0.5, 0.69), (0.82, 1.3), unnamed="arm_?chair|baby|kids"
    ),
    "armchair": Role(("chair",), (0.65, 1.15), (0.69, 1.0), (0.65, 1.15)),
    "stool": Role(("stool",), (0.28, 0.7), (0.28, 0.7), (0.36, 0.54)),
    "bar stool": Role(("stool",), (0.3, 0.5), (0.3, 0.5), (0.6, 1.0)),
    # Beds and sofas
    "bed": Role(("bed",), (0.85, 2.1), (1.85, 2.35), (0.4, 1.3), unnamed="hospital"),
    "nightstand": Role(
        ("nightstand", "drawer_unit", "table"),
        (0.3, 0.62),
        (0.28, 0.55),
        (0.4, 0.7),
        top_m2=0.08,
    ),
    "sofa": Role(("sofa",), (1.25, 2.5), (0.65, 1.2), (0.6, 1.05)),
    # Along walls
    "wardrobe": Role(("wardrobe",), (0.5, 2.3), (0.4, 0.75), (1.5, 2.3)),
    "chest": Role(("drawer_unit",), (0.6, 1.65), (0.35, 0.62), (0.65, 1.3), top_m2=0.2),
    "pedestal": Role(("drawer_unit",), (0.3, 0.5), (0.4, 0.65), (0.5, 0.78), top_m2=0.08),
    "sideboard": Role(("cabinet",), (0.9, 1.9), (0.3, 0.56), (0.6, 1.0), top_m2=0.25),
    "tv bench": Role(("cabinet",), (0.9, 1.9), (0.3, 0.56), (0.35, 0.6), top_m2=0.25),
    "tall cabinet": Role(("cabinet",), (0.5, 1.2), (0.3, 0.65), (1.05, 2.2)),
    "bookshelf": Role(("bookshelf",), (0.4, 1.7), (0.2, 0.52), (0.7, 2.3), top_m2=0.04),
    "wall shelf": Role(
        ("bookshelf",), (0.3, 1.1), (0.15, 0.4), (0.08, 0.95), ("wall",), top_m2=0.04
    ),
    "floor plant": Role(("plant",), (0.2, 1.05), (0.2, 1.0), (0.5, 1.85), _STANDING),
    "floor lamp": Role(("lamp",), (0.2, 0.6), (0.2, 0.6), (1.2, 2.0), _STANDING),
    "bin": Role(("bin",), (0.15, 0.5), (0.15, 0.5), (0.2, 0.75), _STANDING),
    "bag": Role(("bag",), (0.15, 0.6), (0.09, 0.4), (0.18, 0.7), _STANDING),
    "floor box": Role(("box",), (0.3, 0.8), (0.25, 0.65), (0.1, 0.5), _STANDING),
    "rug": Role(("rug",), (0.5, 2.2), (0.3, 2.7), (0.002, 0.06)),
    # On walls and from ceilings
    "wall lamp": Role(
        ("lamp",), (0.04, 0.6), (0.04, 0.45), (0.08, 0.7), ("wall",), unnamed=f"{_HANGS}|track"
    ),
    "ceiling lamp": Role(
        ("lamp",), (0.1, 0.9), (0.1, 0.9), (0.04, 0.9), ("wall", "ceiling"), named=_HANGS
    ),
    "wall screen": Role(("monitor",), (0.5, 1.6), (0.04, 0.2), (0.3, 1.0), ("wall",)),
    "picture": Role(("picture",), (0.12, 1.6), (0.005, 0.16), (0.12, 1.4), ("wall",)),
    "mirror": Role(("mirror",), (0.2, 1.2), (0.005, 0.16), (0.3, 1.8), ("wall",)),
    "curtain": Role(("curtain",), (0.5, 1.6), (0.01, 0.3), (0.8, 2.4), ("wall",)),
    # On desks
    "monitor": Role(("monitor",), (0.35, 0.85), (0.08, 0.35), (0.3, 0.6), _STANDING),
    "television": Role(("monitor",), (0.55, 1.5), (0.08, 0.35), (0.4, 0.95), _STANDING),
    "keyboard": Role(("keyboard",), (0.25, 0.5), (0.09, 0.22), (0.008, 0.06), _STANDING),
    "mouse": Role(("mouse",), (0.04, 0.1), (0.06, 0.14), (0.02, 0.06), _STANDING),
    "laptop": Role(("laptop",), (0.25, 0.45), (0.18, 0.42), (0.012, 0.32), _STANDING),
    "phone": Role(("phone",), (0.04, 0.25), (0.06, 0.25), (0.006, 0.2), _STANDING),
    "desk lamp": Role(("lamp",), (0.1, 0.32), (0.1, 0.52), (0.3, 0.56), _STANDING),
    "table lamp": Role(("lamp",), (0.1, 0.36), (0.1, 0.36), (0.2, 0.6), _STANDING),
    # Small things
    "book": Role(("book",), (0.09, 0.3), (0.15, 0.35), (0.006, 0.08), _STANDING),
    "thick book": Role(
        ("book",), (0.09, 0.3), (0.15, 0.35), (0.0165, 0.08), _STANDING, top_m2=0.012
    ),
    "closed box": Role(("box",), (0.2, 0.46), (0.15, 0.36), (0.06, 0.3), _STANDING, top_m2=0.03),
    "carton": Role(("box",), (0.3, 0.6), (0.25, 0.42), (0.1, 0.36), _STANDING, top_m2=0.05),
    "small box": Role(("box",), (0.08, 0.36), (0.04, 0.31), (0.05, 0.2), _STANDING),
    "cup": Role(("cup",), (0.05, 0.15), (0.05, 0.15), (0.04, 0.22), _STANDING),
    "bowl": Role(("bowl",), (0.1, 0.35), (0.1, 0.35), (0.04, 0.18), _STANDING),
    "bottle": Role(("bottle",), (0.04, 0.12), (0.04, 0.12), (0.12, 0.35), _STANDING),
    "vase": Role(("vase",), (0.06, 0.3), (0.06, 0.3), (0.08, 0.5), _STANDING),
    "small plant": Role(("plant",), (0.08, 0.36), (0.08, 0.36), (0.1, 0.45), _STANDING),
    "clock": Role(("clock",), (0.05, 0.3), (0.03, 0.2), (0.05, 0.35), _STANDING),
    "remote": Role(("remote",), (0.03, 0.08), (0.1, 0.25), (0.008, 0.05), _STANDING),
    "cushion": Role(("cushion",), (0.3, 0.6), (0.1, 0.6), (0.08, 0.3), _STANDING),
}
"""By name. A name that is also a class's is the role, not the class."""
