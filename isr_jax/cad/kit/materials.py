"""What kit models are made of. Densities are handbook values, or effective ones where a part
stands for something hollow or filled (tubes, insulated walls, upholstery); they say so."""

from __future__ import annotations

import dataclasses

Rgba = tuple[float, float, float, float]


@dataclasses.dataclass(frozen=True)
class Material:
    """A density, a colour, and how it slides."""

    name: str
    density_kg_m3: float
    rgba: Rgba
    friction: float = 0.5
    """Sliding friction on common floors and boards, Coulomb, no unit."""


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

RED_BOARD = Material("red_board", 660.0, (0.60, 0.22, 0.18, 1.0))
YELLOW_BOARD = Material("yellow_board", 660.0, (0.85, 0.68, 0.30, 1.0))
SAND_BOARD = Material("sand_board", 660.0, (0.80, 0.74, 0.64, 1.0))
WALNUT_BOARD = Material("walnut_board", 660.0, (0.43, 0.30, 0.20, 1.0))
PINE_BOARD = Material("pine_board", 520.0, (0.88, 0.74, 0.52, 1.0))
# Sheet steel of 0.8 mm in boards that are drawn 18 mm thick.
GREY_METAL_BOARD = Material("grey_metal_board", 380.0, (0.62, 0.64, 0.66, 1.0))
BLUE_METAL_BOARD = Material("blue_metal_board", 380.0, (0.27, 0.40, 0.52, 1.0))
MIRROR = Material("mirror", 900.0, (0.78, 0.84, 0.88, 1.0), 0.4)

# A frame of boards around air.
PLINTH = Material("plinth", 130.0, (0.16, 0.16, 0.17, 1.0))

STONE = Material("stone", 2700.0, (0.35, 0.35, 0.37, 1.0))
LAMINATE = Material("laminate", 700.0, (0.50, 0.43, 0.37, 1.0))
GLASS = Material("glass", 2500.0, (0.70, 0.82, 0.84, 0.55), 0.4)
CERAMIC = Material("ceramic", 2300.0, (0.94, 0.94, 0.90, 1.0), 0.4)
BLUE_CERAMIC = Material("blue_ceramic", 2300.0, (0.25, 0.42, 0.62, 1.0), 0.4)
RED_CERAMIC = Material("red_ceramic", 2300.0, (0.72, 0.22, 0.18, 1.0), 0.4)

STEEL = Material("steel", 7800.0, (0.72, 0.73, 0.75, 1.0))
# A 30 mm square tube of 2 mm steel is filled to a quarter.
STEEL_TUBE = Material("steel_tube", 1950.0, (0.66, 0.67, 0.69, 1.0))
BLACK_TUBE = Material("black_tube", 1950.0, (0.10, 0.10, 0.11, 1.0))
WHITE_TUBE = Material("white_tube", 1950.0, (0.92, 0.92, 0.91, 1.0))
CHROME_TUBE = Material("chrome_tube", 1950.0, (0.80, 0.81, 0.83, 1.0))
BRASS_TUBE = Material("brass_tube", 1950.0, (0.76, 0.62, 0.34, 1.0))
# Nylon wheels on a steel axle.
CASTOR = Material("castor", 1100.0, (0.14, 0.14, 0.15, 1.0), 0.6)

PLASTIC = Material("plastic", 1050.0, (0.30, 0.31, 0.33, 1.0), 0.4)
WHITE_PLASTIC = Material("white_plastic", 1050.0, (0.90, 0.90, 0.88, 1.0), 0.4)
BLUE_PLASTIC = Material("blue_plastic", 1050.0, (0.20, 0.38, 0.62, 1.0), 0.4)
GREEN_PLASTIC = Material("green_plastic", 1050.0, (0.25, 0.50, 0.30, 1.0), 0.4)

# Foam on springs and a light frame, cover included.
GREY_FABRIC = Material("grey_fabric", 75.0, (0.47, 0.48, 0.50, 1.0), 0.6)
BLUE_FABRIC = Material("blue_fabric", 75.0, (0.25, 0.33, 0.47, 1.0), 0.6)
BEIGE_FABRIC = Material("beige_fabric", 75.0, (0.78, 0.70, 0.58, 1.0), 0.6)
GREEN_FABRIC = Material("green_fabric", 75.0, (0.33, 0.42, 0.32, 1.0), 0.6)
RED_FABRIC = Material("red_fabric", 75.0, (0.58, 0.20, 0.20, 1.0), 0.6)
YELLOW_FABRIC = Material("yellow_fabric", 75.0, (0.83, 0.64, 0.22, 1.0), 0.6)
BLACK_FABRIC = Material("black_fabric", 75.0, (0.15, 0.15, 0.16, 1.0), 0.6)
ROSE_FABRIC = Material("rose_fabric", 75.0, (0.78, 0.55, 0.52, 1.0), 0.6)
BLACK_LEATHER = Material("black_leather", 110.0, (0.11, 0.10, 0.10, 1.0), 0.6)
COGNAC_LEATHER = Material("cognac_leather", 110.0, (0.58, 0.33, 0.16, 1.0), 0.6)
# Woven plastic in a frame, the back of office chairs.
MESH_FABRIC = Material("mesh_fabric", 200.0, (0.20, 0.21, 0.22, 1.0), 0.6)
LEATHER = Material("leather", 110.0, (0.35, 0.20, 0.13, 1.0), 0.6)
# Pine with as much air between.
SLATS = Material("slats", 250.0, (0.86, 0.74, 0.54, 1.0))
MATTRESS = Material("mattress", 55.0, (0.93, 0.92, 0.88, 1.0), 0.6)
BLUE_BLANKET = Material("blue_blanket", 45.0, (0.33, 0.42, 0.56, 1.0), 0.6)
GREY_BLANKET = Material("grey_blanket", 45.0, (0.56, 0.56, 0.55, 1.0), 0.6)
GREEN_BLANKET = Material("green_blanket", 45.0, (0.45, 0.53, 0.44, 1.0), 0.6)
ROSE_BLANKET = Material("rose_blanket", 45.0, (0.77, 0.58, 0.55, 1.0), 0.6)
PILLOW = Material("pillow", 35.0, (0.85, 0.87, 0.90, 1.0), 0.6)

# Sheet metal around foam.
WHITE_INSULATED = Material("white_insulated", 170.0, (0.92, 0.93, 0.93, 1.0))
STEEL_INSULATED = Material("steel_insulated", 170.0, (0.68, 0.70, 0.72, 1.0))
DARK_INSULATED = Material("dark_insulated", 170.0, (0.20, 0.21, 0.22, 1.0))
LINER = Material("liner", 120.0, (0.96, 0.96, 0.96, 1.0), 0.4)
# Compressor, transformer, electronics with the air between.
MACHINERY = Material("machinery", 500.0, (0.25, 0.25, 0.27, 1.0))
SHEET_BODY = Material("sheet_body", 500.0, (0.16, 0.16, 0.17, 1.0))
SILVER_BODY = Material("silver_body", 500.0, (0.70, 0.71, 0.72, 1.0))
WHITE_BODY = Material("white_body", 500.0, (0.91, 0.91, 0.90, 1.0))
DISPLAY_SHELL = Material("display_shell", 260.0, (0.14, 0.14, 0.15, 1.0))
SILVER_SHELL = Material("silver_shell", 260.0, (0.66, 0.67, 0.69, 1.0))
SCREEN = Material("screen", 900.0, (0.05, 0.06, 0.08, 1.0), 0.4)

PAPER = Material("paper", 800.0, (0.95, 0.93, 0.86, 1.0))
RED_COVER = Material("red_cover", 900.0, (0.65, 0.16, 0.14, 1.0))
BLUE_COVER = Material("blue_cover", 900.0, (0.15, 0.28, 0.52, 1.0))
GREEN_COVER = Material("green_cover", 900.0, (0.16, 0.40, 0.26, 1.0))
YELLOW_COVER = Material("yellow_cover", 900.0, (0.85, 0.66, 0.18, 1.0))
BLACK_COVER = Material("black_cover", 900.0, (0.12, 0.12, 0.13, 1.0))

# Appliances. Sheet metal around mineral wool (ovens), around air and bitumen mats (washers).
WHITE_OVEN = Material("white_oven", 250.0, (0.93, 0.93, 0.92, 1.0))
STEEL_OVEN = Material("steel_oven", 250.0, (0.70, 0.71, 0.73, 1.0))
BLACK_OVEN = Material("black_oven", 250.0, (0.12, 0.12, 0.13, 1.0))
CREAM_OVEN = Material("cream_oven", 250.0, (0.90, 0.85, 0.72, 1.0))
RED_OVEN = Material("red_oven", 250.0, (0.62, 0.13, 0.12, 1.0))
OVEN_LINING = Material("oven_lining", 250.0, (0.20, 0.21, 0.24, 1.0), 0.4)
# 1 mm of enamelled steel in plates that are drawn 3 mm thick.
ENAMEL = Material("enamel", 2600.0, (0.16, 0.17, 0.20, 1.0), 0.4)
WHITE_SHEET = Material("white_sheet", 480.0, (0.93, 0.94, 0.94, 1.0))
STEEL_SHEET = Material("steel_sheet", 480.0, (0.70, 0.71, 0.73, 1.0))
DARK_SHEET = Material("dark_sheet", 480.0, (0.20, 0.21, 0.23, 1.0))
STEEL_LINER = Material("steel_liner", 350.0, (0.78, 0.79, 0.80, 1.0))
COUNTERWEIGHT = Material("counterweight", 2300.0, (0.55, 0.54, 0.52, 1.0))
RUBBER = Material("rubber", 1150.0, (0.22, 0.22, 0.23, 1.0), 0.9)
# Two panes with air between; a plate of black glass over coils.
OVEN_GLASS = Material("oven_glass", 900.0, (0.06, 0.06, 0.07, 1.0), 0.4)
HOB_GLASS = Material("hob_glass", 2500.0, (0.05, 0.05, 0.06, 1.0), 0.4)
HOB_ZONE = Material("hob_zone", 2500.0, (0.24, 0.24, 0.26, 1.0), 0.4)
CAST_IRON = Material("cast_iron", 7200.0, (0.13, 0.13, 0.14, 1.0), 0.4)
# A bowl of glass, blown thin.
PORTHOLE = Material("porthole", 500.0, (0.33, 0.40, 0.45, 0.75), 0.4)
# Wires with a mesh of air between, as racks of dishwashers have.
WIRE_MESH = Material("wire_mesh", 400.0, (0.72, 0.74, 0.77, 0.6), 0.4)

# Sanitary ware is cast hollow; acrylic tubs are 5 mm skins on a frame; taps are hollow brass.
SANITARY = Material("sanitary", 560.0, (0.96, 0.96, 0.95, 1.0), 0.4)
FIRECLAY = Material("fireclay", 1500.0, (0.95, 0.95, 0.94, 1.0), 0.4)
FIRECLAY_BLACK = Material("fireclay_black", 1500.0, (0.13, 0.13, 0.14, 1.0), 0.4)
BLACK_SANITARY = Material("black_sanitary", 560.0, (0.12, 0.12, 0.13, 1.0), 0.4)
STONE_SANITARY = Material("stone_sanitary", 1400.0, (0.60, 0.58, 0.55, 1.0), 0.4)
TUB_SKIRT = Material("tub_skirt", 65.0, (0.96, 0.96, 0.96, 1.0), 0.4)
TUB_SHELL = Material("tub_shell", 360.0, (0.97, 0.97, 0.97, 1.0), 0.4)
CHROME = Material("chrome", 3200.0, (0.80, 0.81, 0.83, 1.0), 0.4)
BLACK_METAL = Material("black_metal", 3200.0, (0.10, 0.10, 0.11, 1.0), 0.4)
BRASS = Material("brass", 3200.0, (0.74, 0.60, 0.33, 1.0), 0.4)
# 1 mm of sheet in walls that are drawn 4 mm thick.
THIN_STEEL = Material("thin_steel", 2000.0, (0.74, 0.75, 0.77, 1.0), 0.5)

# Portable electronics: metal or plastic shells filled with boards and cells.
ALUMINIUM_DEVICE = Material("aluminium_device", 1000.0, (0.74, 0.75, 0.77, 1.0), 0.6)
DARK_DEVICE = Material("dark_device", 1000.0, (0.16, 0.17, 0.18, 1.0), 0.6)
BLUE_DEVICE = Material("blue_device", 1000.0, (0.22, 0.30, 0.42, 1.0), 0.6)
BLACK_CASE = Material("black_case", 450.0, (0.11, 0.11, 0.12, 1.0), 0.6)
KEYBOARD_SILVER = Material("keyboard_silver", 450.0, (0.74, 0.75, 0.77, 1.0), 0.6)
DARK_KEYS = Material("dark_keys", 500.0, (0.10, 0.10, 0.11, 1.0), 0.6)
WHITE_KEYS = Material("white_keys", 500.0, (0.92, 0.92, 0.91, 1.0), 0.6)
GREY_KEYS = Material("grey_keys", 500.0, (0.42, 0.43, 0.45, 1.0), 0.6)
BLACK_PLASTIC = Material("black_plastic", 1050.0, (0.09, 0.09, 0.10, 1.0), 0.4)
# 0.6 mm of steel in walls that are drawn 3 mm thick.
KETTLE_STEEL = Material("kettle_steel", 1700.0, (0.76, 0.77, 0.79, 1.0), 0.5)
RED_KETTLE = Material("red_kettle", 1700.0, (0.66, 0.12, 0.12, 1.0), 0.5)
CREAM_KETTLE = Material("cream_kettle", 1700.0, (0.91, 0.86, 0.74, 1.0), 0.5)
KETTLE_GLASS = Material("kettle_glass", 1600.0, (0.72, 0.82, 0.86, 0.5), 0.4)

# A full bottle: glass or plastic and contents together.
WINE_BOTTLE = Material("wine_bottle", 1150.0, (0.10, 0.20, 0.12, 1.0), 0.4)
WATER_BOTTLE = Material("water_bottle", 1000.0, (0.55, 0.74, 0.86, 0.6), 0.4)
MILK_BOTTLE = Material("milk_bottle", 1050.0, (0.95, 0.95, 0.92, 1.0), 0.4)
OIL_BOTTLE = Material("oil_bottle", 1100.0, (0.62, 0.56, 0.14, 0.8), 0.4)
BEER_BOTTLE = Material("beer_bottle", 1300.0, (0.33, 0.17, 0.06, 0.9), 0.4)
GREEN_GLASS = Material("green_glass", 2500.0, (0.20, 0.38, 0.24, 0.6), 0.4)
WOODEN_BOWL = Material("wooden_bowl", 650.0, (0.60, 0.42, 0.26, 1.0), 0.45)

# Corrugated board: 0.55 kg/m2 at 4 mm.
CARDBOARD = Material("cardboard", 140.0, (0.72, 0.55, 0.36, 1.0), 0.45)
CARDBOARD_LID = Material("cardboard_lid", 45.0, (0.66, 0.50, 0.33, 1.0), 0.45)
CARDBOARD_INSIDE = Material("cardboard_inside", 140.0, (0.62, 0.47, 0.30, 1.0), 0.45)
GREY_PLASTIC = Material("grey_plastic", 1050.0, (0.62, 0.64, 0.66, 1.0), 0.4)
# Lids and feet of 2 mm of plastic around air.
GREY_LID = Material("grey_lid", 150.0, (0.50, 0.52, 0.54, 1.0), 0.4)
BLACK_LID = Material("black_lid", 250.0, (0.16, 0.16, 0.17, 1.0), 0.4)
WHITE_LID = Material("white_lid", 250.0, (0.92, 0.92, 0.90, 1.0), 0.4)
BLUE_LID = Material("blue_lid", 150.0, (0.20, 0.38, 0.62, 1.0), 0.4)
# 0.5 mm of steel in walls that are drawn 2 mm thick.
BIN_STEEL = Material("bin_steel", 2000.0, (0.74, 0.75, 0.77, 1.0), 0.5)
RED_PLASTIC = Material("red_plastic", 1050.0, (0.70, 0.16, 0.14, 1.0), 0.4)
CLEAR_PLASTIC = Material("clear_plastic", 1050.0, (0.85, 0.90, 0.93, 0.5), 0.4)

# Sheets of 0.2 mm, drawn 2 mm thick so that contact sees them.
KRAFT_PAPER = Material("kraft_paper", 110.0, (0.76, 0.60, 0.42, 1.0), 0.45)
WHITE_PAPER = Material("white_paper", 110.0, (0.92, 0.92, 0.90, 1.0), 0.45)
COTTON = Material("cotton", 150.0, (0.88, 0.84, 0.74, 1.0), 0.6)
CORD = Material("cord", 400.0, (0.45, 0.35, 0.26, 1.0), 0.6)
# Bags with things in them and air between.
LEATHER_GOODS = Material("leather_goods", 140.0, (0.45, 0.26, 0.15, 1.0), 0.55)
RED_LEATHER = Material("red_leather", 140.0, (0.55, 0.13, 0.14, 1.0), 0.55)
BLACK_TRIM = Material("black_trim", 700.0, (0.09, 0.09, 0.10, 1.0), 0.55)
BLUE_CLOTH = Material("blue_cloth", 110.0, (0.18, 0.27, 0.42, 1.0), 0.6)
BLACK_CLOTH = Material("black_cloth", 110.0, (0.14, 0.14, 0.15, 1.0), 0.6)
GREEN_CLOTH = Material("green_cloth", 110.0, (0.30, 0.36, 0.24, 1.0), 0.6)
RED_CLOTH = Material("red_cloth", 110.0, (0.60, 0.17, 0.16, 1.0), 0.6)
# An empty case of polycarbonate, its lining, rails and air.
BLUE_SHELL = Material("blue_shell", 42.0, (0.16, 0.28, 0.44, 1.0), 0.4)
SILVER_CASE = Material("silver_case", 42.0, (0.70, 0.71, 0.73, 1.0), 0.4)
BLACK_SHELL = Material("black_shell", 42.0, (0.13, 0.13, 0.14, 1.0), 0.4)

# Lamps: shades of cloth or sheet metal, drawn 2 to 3 mm thick.
LAMP_CLOTH = Material("lamp_cloth", 150.0, (0.94, 0.90, 0.80, 1.0), 0.5)
GREY_LAMP_CLOTH = Material("grey_lamp_cloth", 150.0, (0.60, 0.60, 0.58, 1.0), 0.5)
SHADE_METAL = Material("shade_metal", 1500.0, (0.14, 0.14, 0.15, 1.0), 0.5)
RED_METAL = Material("red_metal", 1500.0, (0.66, 0.15, 0.12, 1.0), 0.5)
WHITE_METAL = Material("white_metal", 1500.0, (0.92, 0.92, 0.90, 1.0), 0.5)
# Slip-cast bodies are 5 mm walls around air.
CAST_CERAMIC = Material("cast_ceramic", 650.0, (0.93, 0.92, 0.88, 1.0), 0.4)
BLUE_CAST_CERAMIC = Material("blue_cast_ceramic", 650.0, (0.25, 0.42, 0.62, 1.0), 0.4)
OPAL_GLASS = Material("opal_glass", 330.0, (0.97, 0.95, 0.90, 1.0), 0.4)
BULB = Material("bulb", 500.0, (1.0, 0.96, 0.84, 1.0), 0.4)

TERRACOTTA = Material("terracotta", 1900.0, (0.70, 0.39, 0.26, 1.0), 0.55)
CONCRETE = Material("concrete", 2300.0, (0.60, 0.60, 0.58, 1.0), 0.6)
# Moist potting soil.
SOIL = Material("soil", 700.0, (0.20, 0.14, 0.10, 1.0), 0.6)
STEM = Material("stem", 600.0, (0.34, 0.44, 0.20, 1.0), 0.5)
BARK = Material("bark", 700.0, (0.40, 0.30, 0.21, 1.0), 0.6)
LEAF = Material("leaf", 600.0, (0.20, 0.42, 0.18, 1.0), 0.4)
DARK_LEAF = Material("dark_leaf", 600.0, (0.11, 0.30, 0.15, 1.0), 0.4)
PALE_LEAF = Material("pale_leaf", 600.0, (0.46, 0.58, 0.30, 1.0), 0.4)
CACTUS = Material("cactus", 900.0, (0.28, 0.47, 0.30, 1.0), 0.5)
# Leaves and twigs with the air between.
FOLIAGE = Material("foliage", 12.0, (0.22, 0.44, 0.19, 1.0), 0.5)

# Door leaves: boards around tubular particle board; frames of solid wood.
WHITE_DOOR = Material("white_door", 300.0, (0.93, 0.93, 0.91, 1.0))
OAK_DOOR = Material("oak_door", 300.0, (0.74, 0.58, 0.38, 1.0))
GREY_DOOR = Material("grey_door", 300.0, (0.45, 0.47, 0.49, 1.0))
GREEN_DOOR = Material("green_door", 380.0, (0.18, 0.33, 0.27, 1.0))
WHITE_FRAME = Material("white_frame", 500.0, (0.91, 0.91, 0.89, 1.0))
# A lever, hollow; what balances it is solid.
LEVER = Material("lever", 700.0, (0.72, 0.73, 0.75, 1.0), 0.45)
# Window profiles: PVC with steel inside, or aluminium, both mostly chambers.
PVC_PROFILE = Material("pvc_profile", 550.0, (0.95, 0.95, 0.95, 1.0), 0.4)
DARK_PROFILE = Material("dark_profile", 600.0, (0.20, 0.21, 0.23, 1.0), 0.4)
# Two panes of 4 mm around 16 mm of gas.
DOUBLE_GLAZING = Material("double_glazing", 830.0, (0.72, 0.84, 0.88, 0.35), 0.4)
