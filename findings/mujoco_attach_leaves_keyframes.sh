#!/bin/sh
# Guess: MjSpec.attach puts a model at a frame of another one, and the keyframes that come along
#   put it there too, as its own qpos0 does.
# Truth: a keyframe of a model with a free joint keeps the pose of the child's own file. The start
#   (qpos0) is at the frame; a reset to the keyframe "home" puts the model back at its own origin.
# Why it matters: robots with a floating base come with a keyframe "home". Two of them in one scene
#   stand at their frames until the first reset to the keyframe, and then inside each other.
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

ROBOT = """<mujoco><worldbody>
  <body name="base" pos="0 0 .5"><freejoint/><geom size=".1"/></body>
</worldbody><keyframe><key name="home" qpos="0 0 .5 1 0 0 0"/></keyframe></mujoco>"""
ROOM = '<mujoco><worldbody><geom type="plane" size="5 5 .1"/></worldbody></mujoco>'
FRAME = [2.0, 3.0, 0.0]

room, robot = mujoco.MjSpec.from_string(ROOM), mujoco.MjSpec.from_string(ROBOT)
room.attach(robot, prefix="a_", frame=room.worldbody.add_frame(pos=FRAME))
model = room.compile()
data = mujoco.MjData(model)
mujoco.mj_forward(model, data)
start = data.body("a_base").xpos.copy()
mujoco.mj_resetDataKeyframe(model, data, model.key("a_home").id)
mujoco.mj_forward(model, data)
reset = data.body("a_base").xpos.copy()

print("mujoco", mujoco.__version__)
print("frame of the attachment:", FRAME)
print("base at the start:      ", start)
print("base after the keyframe:", reset)
if not np.allclose(start, [2, 3, 0.5]):
    sys.exit("otherwise: the start is not at the frame")
if not np.allclose(reset, [0, 0, 0.5]):
    sys.exit("otherwise: the keyframe does not leave the model at its own origin")
print("as described")
PYTHON
