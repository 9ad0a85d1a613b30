#!/bin/sh
# Guess: the parts of a convex decomposition cover the mesh and stay within its bounds, whether
#   the mesh is closed or not.
# Truth: CoACD first rebuilds a mesh that is not closed as a level set around it, with its default
#   preprocess_mode "auto". A box without its lid, 2 m long, comes back 11 mm larger on every
#   closed side; with the lid it comes back exact.
# Why it matters: furniture from scans and from modelling tools is open as often as not. Its
#   collision parts then stand in the floor, in the wall and in their neighbours at the start.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet coacd==1.0.14 numpy==2.4.4
venv/bin/python - <<'PYTHON'
import itertools
import sys
from importlib.metadata import version

import coacd
import numpy as np

SIZE = np.array([2.0, 1.0, 0.5])
VERTICES = (np.array(list(itertools.product((0, 1), repeat=3))) - 0.5) * SIZE
QUADS = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
LID = QUADS.index([1, 5, 7, 3])


def bounds(quads):
    faces = np.array([t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))])
    parts = coacd.run_coacd(coacd.Mesh(VERTICES, faces), threshold=0.05, seed=0)
    corners = np.concatenate([vertices for vertices, _ in parts])
    return len(parts), corners.min(0), corners.max(0)


coacd.set_log_level("error")
print("coacd", version("coacd"))
grown = {}
for name, quads in (("closed", QUADS), ("without lid", QUADS[:LID] + QUADS[LID + 1 :])):
    count, low, high = bounds(quads)
    grown[name] = 1000 * np.array([-SIZE / 2 - low, high - SIZE / 2])
    print(f"{name}: {count} parts; out of the mesh, mm, x y z")
    print("  lower side", np.round(grown[name][0], 2), " upper side", np.round(grown[name][1], 2))

closed_sides = np.delete(grown["without lid"].ravel(), 5)  # upper z is where the lid is missing
if abs(grown["closed"]).max() > 0.01:
    sys.exit("otherwise: a closed mesh is not exact")
if closed_sides.min() < 5:
    sys.exit("otherwise: an open mesh hardly grows")
print("as described")
PYTHON
