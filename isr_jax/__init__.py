"""Turn a walk through a room with an RGB-D camera into a room that a robot can act in."""
