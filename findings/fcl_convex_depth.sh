#!/bin/sh
# Guess: for two convex shapes fcl.collide reports the penetration depth: the least distance by
#   which one must be moved to leave the other.
# Truth: for thin boards given as fcl.Convex it is often far too deep. Two boards of 18 mm that
#   overlap by 8 mm are reported 200 mm deep, along another axis; given as fcl.Box the same boards
#   are 8 mm deep. The move that fcl reports does part them, but it is not the least.
# Why it matters: convex hulls of furniture are boards. Depth from FCL says that a model cannot
#   stand where it can, and pushes things apart along the wrong side.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet python-fcl==0.7.0.11 numpy==2.4.4
venv/bin/python - <<'PYTHON'
import itertools
import sys
from importlib.metadata import version

import fcl
import numpy as np

CORNERS = np.array(list(itertools.product((-0.5, 0.5), repeat=3)))
FACES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
UPRIGHT, SHELF, OFFSET = (0.018, 0.2, 1.0), (0.018, 1.0, 0.3), np.array([0.010, 0.4, 0.1])


def convex(size):
    for face in FACES:  # counter-clockwise seen from outside, as fcl asks
        a, b, c, _ = CORNERS[face]
        assert np.cross(b - a, c - b) @ CORNERS[face].mean(0) > 0
    return fcl.Convex(CORNERS * size, len(FACES), np.array([i for f in FACES for i in (4, *f)]))


def deepest(shape_a, shape_b, offset):
    request = fcl.CollisionRequest(num_max_contacts=100, enable_contact=True)
    result = fcl.CollisionResult()
    there = fcl.Transform(np.eye(3), offset)
    fcl.collide(fcl.CollisionObject(shape_a), fcl.CollisionObject(shape_b, there), request, result)
    return max(result.contacts, key=lambda c: c.penetration_depth, default=None)


true_m = ((np.array(UPRIGHT) + SHELF) / 2 - abs(OFFSET)).min()
as_convex = deepest(convex(UPRIGHT), convex(SHELF), OFFSET)
as_box = deepest(fcl.Box(*UPRIGHT), fcl.Box(*SHELF), OFFSET)
print("python-fcl", version("python-fcl"))
print(f"overlap of the boards:   {1000 * true_m:7.3f} mm, along x")
for name, contact in (("Convex", as_convex), ("Box", as_box)):
    depth_mm = 1000 * contact.penetration_depth
    print(f"fcl, both as {name + ':':11} {depth_mm:7.3f} mm, normal {np.round(contact.normal, 3)}")
apart = OFFSET + [true_m + 1e-4, 0, 0]
parted = deepest(convex(UPRIGHT), convex(SHELF), apart) is None
print("fcl, moved by 8.1 mm along x:", "no contact" if parted else "contact")

if not np.isclose(as_box.penetration_depth, true_m, atol=1e-6):
    sys.exit("otherwise: the depth of boxes is not their overlap")
if as_convex.penetration_depth < 10 * true_m or not parted:
    sys.exit("otherwise: the depth of convex boards is near their overlap")
print("as described")
PYTHON
