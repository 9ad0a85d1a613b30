"""Border: MuJoCo. Load any scene, look for contacts, let it settle, push it, move its joints.

    from isr_jax import simulation

    model = simulation.load_model("scene.xml")           # MJCF or URDF
    simulation.touches(model)                            # who overlaps whom, how deep
    path = simulation.simulate(model, duration_s=5.0)    # where bodies and joints go by themselves
    simulation.joint_travel(model, "door").share         # how far a joint can be moved

Lengths are metres, angles radians, times seconds; poses are in MuJoCo's world frame, z up where
gravity is MuJoCo's default. A body or joint without a name is called by its number: ``#3``.
"""

from .contacts import Touch, touches
from .joints import JointTravel, joint_ranges, joint_travel, moving_joints
from .motion import Trajectory, perturbed_start, push, simulate, solver_warnings
from .scenes import (
    SceneSource,
    bounds,
    free_bodies,
    freed_model,
    is_compiled,
    load_model,
    scene_label,
    static_bodies,
    unfreeable_bodies,
)

__all__ = [
    "JointTravel",
    "SceneSource",
    "Touch",
    "Trajectory",
    "bounds",
    "free_bodies",
    "freed_model",
    "is_compiled",
    "joint_ranges",
    "joint_travel",
    "load_model",
    "moving_joints",
    "perturbed_start",
    "push",
    "scene_label",
    "simulate",
    "solver_warnings",
    "static_bodies",
    "touches",
    "unfreeable_bodies",
]
