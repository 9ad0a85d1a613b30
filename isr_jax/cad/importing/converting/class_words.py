"""Names of things, by class: everyday English, and what catalogues and data sets call them.

Heads of compounds that are no class of ours stand under `OTHER`, so that they are known as such.
"""

from __future__ import annotations

OTHER = "other"
"""Class of what has no row of its own: kept in a library, never matched."""

WORDS: dict[str, str] = {
    "chair": (
        "chair, armchair, arm chair, office chair, swivel chair, side chair, dining chair, "
        "accent chair, recliner, rocking chair, club chair, folding chair, high chair, seat, "
        "class seat, deck chair, beach chair, lounge chair, chair with cushion, wing chair, "
        "cantilever chair"
    ),
    "stool": "stool, bar stool, bar chair, footstool, ottoman, pouf, puff, tabouret, step stool",
    "bench": "bench, banc, bank, piano bench, park bench, little bank, wood bank, pew",
    "table": (
        "table, dining table, coffee table, end table, side table, round table, bar table, "
        "kitchen table, folding table, accent table, picnic table, console table, tea table, "
        "table on trestles, workbench, table with tablecloth"
    ),
    "desk": (
        "desk, writing desk, computer desk, office desk, desk table, technical table, dressing "
        "table, secretary, school desk, drawing table"
    ),
    "sofa": (
        "sofa, couch, loveseat, love seat, settee, sectional, divan, corner sofa, sofa bed, "
        "convertible sofa, chaise longue, chaise lounge, futon couch, sofa 2 seats, sofa 3 "
        "seats, convertible sofa bz, daybed sofa"
    ),
    "bed": (
        "bed, double bed, single bed, bunk bed, bunkbed, baby bed, child bed, crib, cradle, "
        "daybed, day bed, hospital bed, cot, futon, mezzanine bed, loft bed, canopy bed, "
        "bassinet"
    ),
    "nightstand": "nightstand, night stand, bedside table, bedside cabinet, night table",
    "wardrobe": "wardrobe, closet, armoire, clothes closet, wardrobe cabinet, locker",
    "drawer_unit": (
        "drawer unit, chest of drawers, dresser, dresser with drawers, drawers cabinet, "
        "commode, filing cabinet, file cabinet, chest drawers, tallboy, drawer, drawers, "
        "bureau, slide cabinet, pedestal drawers"
    ),
    "cabinet": (
        "cabinet, base cabinet, lower cabinet, cupboard, storage furniture, sideboard, buffet, "
        "tv stand, television cabinet, television stand, tv cabinet, media console, credenza, "
        "high cabinet, box cabinet, hinge cabinet, sink cabinet, corner cabinet, lower corner "
        "cabinet, island, kitchen island, vanity, double vanity, hutch, pantry, shoe cabinet, "
        "changing table, small lower cabinet, glass door cabinet, storage cabinet, display "
        "cabinet, china cabinet, island extension, media chest, tv bench, entertainment center"
    ),
    "wall_cabinet": (
        "wall cabinet, upper cabinet, hanging cabinet, upper corner cabinet, overhead cabinet, "
        "small upper cabinet, upper shelves cabinet, wall mounted cabinet, medicine cabinet"
    ),
    "counter": (
        "counter, countertop, kitchen counter, worktop, reception desk, counters, kitchen unit, "
        "bar counter, vanity counter"
    ),
    "bookshelf": (
        "bookshelf, bookcase, shelf, shelves, book shelf, book case, shelving, etagere, full "
        "bookcase, vertical shelves, rack shelf, shelving unit, storage rack, wall shelf"
    ),
    "fridge": (
        "fridge, refrigerator, freezer, large fridge, chest freezer, refridgerator, fridge "
        "freezer, mini fridge"
    ),
    "microwave": "microwave, microwave oven, small oven",
    "oven": (
        "oven, stove, range, cooker, double oven, range oven, kitchen range, large stove, "
        "kitchen stove, cooking range, propane stove"
    ),
    "dishwasher": "dishwasher, dish washer",
    "washing_machine": (
        "washing machine, clothes washing machine, washer, dryer, dryer machine, tumble dryer, "
        "clothes dryer, laundry machine"
    ),
    "sink": (
        "sink, washbasin, wash basin, basin, lavatory, small lavatory, bathroom sink, kitchen "
        "sink, hand basin"
    ),
    "toilet": "toilet, toilets unit, wc, bidet, urinal, toilet seat, toilet bowl, water closet",
    "bathtub": "bathtub, bath, bath tub, corner bathtub, island bath, tub, jacuzzi, hot tub",
    "monitor": (
        "monitor, tv, television, screen monitor, computer monitor, display, flat tv, tv 16 9, "
        "wall flat tv, lcd, tv monitor, computer screen, flat screen, television set, tv set"
    ),
    "laptop": "laptop, notebook computer, macbook, apple i book, i book, laptop computer",
    "keyboard": "keyboard, computer keyboard",
    "mouse": "computer mouse, mouse",
    "remote": "remote, remote control, tv remote control, remote controller",
    "phone": (
        "phone, telephone, smartphone, mobile phone, cell phone, apple iphone, iphone, wireless "
        "phone, cellphone"
    ),
    "book": "book, hardcover, textbook, paperback, dictionary, notebook, binder",
    "cup": (
        "cup, mug, coffee cup, coffee mug, tea cup, teacup, glass, drinking glass, wine glass, "
        "beer glass, cocktail glass, plastic cup, goblet, tumbler, beer mug, drinking cup"
    ),
    "bowl": (
        "bowl, salad bowl, bowl with fruits, bowl with salad, soup bowl, mixing bowl, fruit "
        "bowl, dish bowl"
    ),
    "bottle": (
        "bottle, wine bottle, beer bottle, flask, flacon, medicine bottle, spray bottle, baby "
        "bottle, water bottle, soda bottle, milk bottle, carafe, jug, drink bottle, yogurt "
        "bottle"
    ),
    "vase": "vase, urn, pottery, amphora, flower vase",
    "plant": (
        "plant, flower, flowers, houseplant, house plant, potted plant, cactus, orchids, "
        "orchid, yucca, tulips, white lily, lily, spathiphyllum, bamboo, ficus, bonsai, bonsai "
        "tree, indoor plant, spider plant, flower box, plant box, plant pot, flower pot, "
        "christmas tree, flowerpot, bouquet, succulent"
    ),
    "lamp": (
        "lamp, desk lamp, table lamp, floor lamp, lantern, ceiling lamp, chandelier, light, "
        "pendant lamp, hanging light, wall light, wall lamp, spotlight, wall spotlight, "
        "lampshade, torchiere, wall lamp artwork, track lights, pedestal vase lamp, chandelier "
        "lamp, sconce, fluorescent light, fluorescent strip, ceiling light, little lamp, "
        "standing lamp, flashlight"
    ),
    "clock": "clock, alarm clock, wall clock, cuckoo clock, grandfather clock",
    "bin": (
        "bin, trash can, trashcan, dustbin, waste bin, garbage bin, rubbish bin, waste basket, "
        "wastebasket, recycling bin, bullet trash can, garbage can, litter bin, trash bin, "
        "dumpster"
    ),
    "bag": (
        "bag, handbag, backpack, suitcase, briefcase, luggage, purse, hand bag, rucksack, "
        "schoolbag, satchel, trolley case"
    ),
    "box": (
        "box, cardboard box, crate, carton, chest, storage box, open cardboard box, trunk, "
        "trunck, gift, medicine box, bread box, safe, toolbox, tool box, letter tray, clothes "
        "basket, basket, shopping basket, open box, moving box, gift box, tissue box, container "
        "box"
    ),
    "kettle": (
        "kettle, teapot, tea pot, water kettle, boiler, electric kettle, espresso kettle, "
        "coffee pot, samovar"
    ),
    "cushion": "cushion, pillow, throw pillow, bolster",
    "door": (
        "door, interior door, exterior door, double door, garage door, screen door, glass door, "
        "shower door, elevator door, sliding door, door frame, double door with panes, door set"
    ),
    "window": (
        "window, french window, double hung window, window frame, turn window, skylight, double "
        "window with large pane, double window 3 panes, double window 4 panes, sliding window, "
        "double french window 3 panes, double french window small panes, arched window, velux, "
        "quadruple french window 3 panes, quadruple french window small panes, window shutter, "
        "shutter"
    ),
    "rug": "rug, carpet, doormat, mat, bathmat, bath mat, oriental rug, round carpet, tatami",
    "curtain": "curtain, shower curtain, drape, window blind, blind, roller blind",
    "picture": (
        "picture, picture frame, painting, photo frame, poster, wall art, frame, frame "
        "chambord, wall picture, artwork, whiteboard, white board, blackboard"
    ),
    "mirror": "mirror, wall mirror",
    OTHER: (
        "brush, dispenser, paper, shower, faucet, tap, rack, hanger, holder, stand, fan, bat, "
        "brewer, maker, machine, hood, range hood, board, blender, mixer, toaster, fryer, "
        "grill, scale, pan, pot, plate, tray, knife, fork, spoon, cutlery, tool, tools, toy, "
        "doll, doll house, house, dog house, hut, car, car model, truck, bus, van, bike, "
        "bicycle, motorbike, scooter, stroller, wheelchair, tricycle, vehicle, boat, rowboat, "
        "plane, airplane, biplane, train, toy train, horse, cat, dog, animal, animals, human, "
        "person, people, male, female, boy, girl, mannequin, man, woman, stairs, staircase, "
        "stairway, escalator, ladder, step ladder, wall, floor, ceiling, fence, railing, "
        "column, pillar, chimney, fireplace, radiator, furnace, heater, water heater, elevator, "
        "swimming pool, pool, tree, hedge, bush, rock, road, street, fountain, street lamp, "
        "street light, lamppost, classic lamppost, park light, umbrella, tent, trampoline, "
        "swing, piano, guitar, speaker, camera, printer, computer, tablet, console, headphones, "
        "helmet, hat, shoe, shoes, clothes, shirt, dress, jacket, towel, socket, plug, switch, "
        "pool table, chess, football table, table tennis, chessboard, game, sport, food, bread, "
        "cake, fruit, apple, watch, glasses, sunglasses, ring, gun, pistol, knife stand, tv "
        "antenna, parking slot, sponge, soap, comb, potty, player, projector, cooktop, hob, "
        "induction cooker, induction cooker 2 zone, induction cooker 4 zone, device, room, "
        "living room, hammock, sleeping bag, abdominal bench, letter box, mailbox, newspaper, "
        "magazine, mattress, air mattress, exercise bench,  bell, key, keys, lock, pen, pencil, "
        "ruler, scissors"
    ),
}
"""Phrases, parted by commas."""
