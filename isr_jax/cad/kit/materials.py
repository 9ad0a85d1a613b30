"""What kit models are made of. Densities are handbook values, or effective ones where a part
stands for something hollow or filled (tubes, insulated walls, upholstery); they say so."""

from __future__ import annotations

import dataclasses

Rgba = tuple[float, float, float, float]


@dataclasses.dataclass(frozen=True)
class Material:
    """A density and a colour."""

    name: str
    density_kg_m3: float
    rgba: Rgba


def wood(name: str, rgb: tuple[float, float, float], density_kg_m3: float = 680.0) -> Material:
    return Material(name, density_kg_m3, (*rgb, 1.0))


OAK = wood("oak", (0.72, 0.55, 0.36), 700.0)
BEECH = wood("beech", (0.82, 0.65, 0.45), 700.0)
WALNUT = wood("walnut", (0.40, 0.27, 0.18), 640.0)
PINE = wood("pine", (0.88, 0.73, 0.50), 510.0)
BIRCH = wood("birch", (0.87, 0.76, 0.58), 650.0)
BLACK_WOOD = wood("black_wood", (0.13, 0.12, 0.12), 680.0)

# Particle board with a decor foil.
WHITE_BOARD = Material("white_board", 660.0, (0.93, 0.93, 0.91, 1.0))
GREY_BOARD = Material("grey_board", 660.0, (0.55, 0.57, 0.58, 1.0))
DARK_BOARD = Material("dark_board", 660.0, (0.22, 0.23, 0.25, 1.0))
OAK_BOARD = Material("oak_board", 660.0, (0.75, 0.60, 0.42, 1.0))
BLUE_BOARD = Material("blue_board", 660.0, (0.24, 0.36, 0.48, 1.0))
GREEN_BOARD = Material("green_board", 660.0, (0.38, 0.48, 0.40, 1.0))

# A frame of boards around air.
PLINTH = Material("plinth", 130.0, (0.16, 0.16, 0.17, 1.0))

STONE = Material("stone", 2700.0, (0.35, 0.35, 0.37, 1.0))
LAMINATE = Material("laminate", 700.0, (0.50, 0.43, 0.37, 1.0))
GLASS = Material("glass", 2500.0, (0.70, 0.82, 0.84, 0.55))
CERAMIC = Material("ceramic", 2300.0, (0.94, 0.94, 0.90, 1.0))
BLUE_CERAMIC = Material("blue_ceramic", 2300.0, (0.25, 0.42, 0.62, 1.0))
RED_CERAMIC = Material("red_ceramic", 2300.0, (0.72, 0.22, 0.18, 1.0))

STEEL = Material("steel", 7800.0, (0.72, 0.73, 0.75, 1.0))
# A 30 mm square tube of 2 mm steel is filled to a quarter.
STEEL_TUBE = Material("steel_tube", 1950.0, (0.66, 0.67, 0.69, 1.0))
BLACK_TUBE = Material("black_tube", 1950.0, (0.10, 0.10, 0.11, 1.0))

PLASTIC = Material("plastic", 1050.0, (0.30, 0.31, 0.33, 1.0))
WHITE_PLASTIC = Material("white_plastic", 1050.0, (0.90, 0.90, 0.88, 1.0))
BLUE_PLASTIC = Material("blue_plastic", 1050.0, (0.20, 0.38, 0.62, 1.0))
GREEN_PLASTIC = Material("green_plastic", 1050.0, (0.25, 0.50, 0.30, 1.0))

# Foam on springs and a light frame, cover included.
GREY_FABRIC = Material("grey_fabric", 75.0, (0.47, 0.48, 0.50, 1.0))
BLUE_FABRIC = Material("blue_fabric", 75.0, (0.25, 0.33, 0.47, 1.0))
BEIGE_FABRIC = Material("beige_fabric", 75.0, (0.78, 0.70, 0.58, 1.0))
GREEN_FABRIC = Material("green_fabric", 75.0, (0.33, 0.42, 0.32, 1.0))
RED_FABRIC = Material("red_fabric", 75.0, (0.58, 0.20, 0.20, 1.0))
LEATHER = Material("leather", 110.0, (0.35, 0.20, 0.13, 1.0))
# Pine with as much air between.
SLATS = Material("slats", 250.0, (0.86, 0.74, 0.54, 1.0))
MATTRESS = Material("mattress", 55.0, (0.93, 0.92, 0.88, 1.0))
PILLOW = Material("pillow", 35.0, (0.85, 0.87, 0.90, 1.0))

# Sheet metal around foam.
WHITE_INSULATED = Material("white_insulated", 170.0, (0.92, 0.93, 0.93, 1.0))
STEEL_INSULATED = Material("steel_insulated", 170.0, (0.68, 0.70, 0.72, 1.0))
DARK_INSULATED = Material("dark_insulated", 170.0, (0.20, 0.21, 0.22, 1.0))
LINER = Material("liner", 120.0, (0.96, 0.96, 0.96, 1.0))
# Compressor, transformer, electronics with the air between.
MACHINERY = Material("machinery", 500.0, (0.25, 0.25, 0.27, 1.0))
SHEET_BODY = Material("sheet_body", 500.0, (0.16, 0.16, 0.17, 1.0))
SILVER_BODY = Material("silver_body", 500.0, (0.70, 0.71, 0.72, 1.0))
WHITE_BODY = Material("white_body", 500.0, (0.91, 0.91, 0.90, 1.0))
DISPLAY_SHELL = Material("display_shell", 260.0, (0.14, 0.14, 0.15, 1.0))
SILVER_SHELL = Material("silver_shell", 260.0, (0.66, 0.67, 0.69, 1.0))
SCREEN = Material("screen", 900.0, (0.05, 0.06, 0.08, 1.0))

PAPER = Material("paper", 800.0, (0.95, 0.93, 0.86, 1.0))
RED_COVER = Material("red_cover", 900.0, (0.65, 0.16, 0.14, 1.0))
BLUE_COVER = Material("blue_cover", 900.0, (0.15, 0.28, 0.52, 1.0))
GREEN_COVER = Material("green_cover", 900.0, (0.16, 0.40, 0.26, 1.0))
YELLOW_COVER = Material("yellow_cover", 900.0, (0.85, 0.66, 0.18, 1.0))
BLACK_COVER = Material("black_cover", 900.0, (0.12, 0.12, 0.13, 1.0))
