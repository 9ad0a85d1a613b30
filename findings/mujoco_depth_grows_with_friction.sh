#!/bin/sh
# Guess: how deep a box at rest sinks into a level floor depends on the stiffness of the contact
#   (solref, solimp), not on the friction coefficient.
# Truth: with MuJoCo's default (pyramidal) cone the depth grows with friction: 0.0006 mm at 0.1,
#   0.64 mm at 2. With cone="elliptic" it is 0.108 mm at any. The edges of the pyramid share the
#   normal force, and the regularization of each depends on the coefficient.
# Why it matters: a figure of penetration compares scenes only under one cone and one friction;
#   tuning friction for grasps changes how stacks sink.
set -eu
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet mujoco==4.0.0 numpy==2.4.4
venv/bin/python - <<'PYTHON'
import sys

import mujoco
import numpy as np

FRICTIONS = (0.1, 0.5, 1.0, 2.0)
BOX = """<mujoco><option cone="{cone}"/><worldbody>
  <geom type="plane" size="3 3 .1" friction="{friction}"/>
  <body pos="0 0 .1"><freejoint/><geom type="box" size=".1 .1 .1" friction="{friction}"/></body>
</worldbody></mujoco>"""


def depth_mm(cone, friction):
    model = mujoco.MjModel.from_xml_string(BOX.format(cone=cone, friction=friction))
    data = mujoco.MjData(model)
    mujoco.mj_step(model, data, round(5 / model.opt.timestep))
    assert abs(data.qvel).max() < 1e-6, "at rest"
    return 1000 * (0.1 - float(data.qpos[2]))


print("mujoco", mujoco.__version__)
default = mujoco.MjModel.from_xml_string("<mujoco/>").opt.cone
print("default cone:", mujoco.mjtCone(default).name)
depth = {cone: [depth_mm(cone, f) for f in FRICTIONS] for cone in ("pyramidal", "elliptic")}
print("friction ", *(f"{f:>10}" for f in FRICTIONS))
for cone, row in depth.items():
    print(f"{cone:9}", *(f"{d:7.4f} mm" for d in row))

pyramidal, elliptic = (np.array(depth[cone]) for cone in depth)
if default != mujoco.mjtCone.mjCONE_PYRAMIDAL:
    sys.exit("otherwise: another cone is the default")
if not np.all(np.diff(pyramidal) > 0) or pyramidal[-1] < 500 * pyramidal[0]:
    sys.exit("otherwise: depth under the pyramidal cone hardly depends on friction")
if np.ptp(elliptic) > 0.001:
    sys.exit("otherwise: depth under the elliptic cone depends on friction")
print("as described")
PYTHON
