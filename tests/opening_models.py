"""Small articulated models whose behaviour is known: a box with a door, a drawer, a wheel."""

from __future__ import annotations

import dataclasses

import numpy as np

from isr_jax.library import CadModel, Handle, held
from isr_jax.robot_model import (
    Joint,
    Link,
    RobotModel,
    Visual,
    box_between,
    combined_properties,
    solid_properties,
)
from isr_jax.types import PlaneSet

from .builders import box_planes

SIZE = np.array([0.5, 0.4, 0.6])
"""Of the carcass."""
BOARD = 0.02
DENSITY = 600.0
Bounds = tuple[tuple[float, float], tuple[float, float], tuple[float, float]]


def solid_link(name: str, *boxes: Bounds, density: float = DENSITY, rgba=None) -> Link:
    """A link of boxes, given by their bounds in x, y, z."""
    hulls = tuple(box_between(*np.array(b, np.float64).T) for b in boxes)
    mass, com, inertia = combined_properties([solid_properties(h, density) for h in hulls])
    rgba = rgba or (0.7, 0.6, 0.5, 1.0)
    visuals = tuple(Visual(f"part_{i}", hull, rgba) for i, hull in enumerate(hulls))
    return Link(name, visuals, hulls, mass, com, inertia)


def carcass(density: float = DENSITY) -> Link:
    """An open box: bottom, top, two sides and a back; z = 0 below, open towards -y."""
    x, y, z = SIZE / 2
    t = BOARD
    return solid_link(
        "base",
        ((-x, x), (-y, y), (-z, -z + t)),
        ((-x, x), (-y, y), (z - t, z)),
        ((-x, -x + t), (-y, y), (-z + t, z - t)),
        ((x - t, x), (-y, y), (-z + t, z - t)),
        ((-x + t, x - t), (y - t, y), (-z + t, z - t)),
        density=density,
    )


def transform(x: float, y: float, z: float) -> np.ndarray:
    T = np.eye(4)
    T[:3, 3] = x, y, z
    return T


def model_of(robot: RobotModel, handles=(), class_name="cabinet", mount="floor") -> CadModel:
    """A model of the carcass's size with its top and left side as planes; the top carries."""
    planes = box_planes(SIZE, faces=(0, 3))
    return CadModel(
        id=f"{class_name}/test",
        class_name=class_name,
        load_robot=held(robot),
        moving_joints=tuple(joint.name for joint in robot.moving_joints),
        size=SIZE.astype(np.float32),
        planes=PlaneSet(*(np.asarray(getattr(planes, f)) for f in vars(planes))),
        plane_link=("base", "base"),
        plane_supporting=np.array([True, False]),
        symmetry=1,
        mount=mount,
        licence="MIT",
        content_hash="test",
        handles=tuple(handles),
    )


def door_model(
    gap_m: float = 0.003, *, lift_m: float = 0.003, upper=np.pi / 2, **options
) -> CadModel:
    """A carcass with a door in front, hinged at its left edge.

    Args:
        gap_m: Between door and carcass; negative: they overlap.
        lift_m: The door's lower edge above the carcass's.
        upper: Opening angle, radians.
        options: ``density`` of the carcass, ``friction`` and ``mount``.
    """
    x, y, z = SIZE / 2
    at = (-x, -y - gap_m, 0.0)
    door = solid_link("door", ((0.0, 2 * x), (-BOARD, 0.0), (-z + lift_m, z)))
    joint = Joint(
        "door_joint",
        "revolute",
        "base",
        "door",
        transform(*at),
        np.array([0.0, 0.0, -1.0]),
        0.0,
        upper,
        damping=0.4,
        friction=options.get("friction", 0.3),
    )
    robot = RobotModel("cabinet_test", (carcass(options.get("density", DENSITY)), door), (joint,))
    handle = Handle("door_joint", "door", np.array([2 * x - 0.04, -BOARD, 0.0]))
    return model_of(robot, [handle], mount=options.get("mount", "floor"))


def drawer_model(
    travel_m: float = 0.3, *, density: float = DENSITY, inside: float = DENSITY, friction=2.0
) -> CadModel:
    """A carcass with one drawer (a solid block of density ``inside``) that slides to -y."""
    x, y, z = SIZE / 2 - BOARD - 0.003
    drawer = solid_link("drawer", ((-x, x), (-y, y), (-z, z)), density=inside)
    joint = Joint(
        "drawer_joint",
        "prismatic",
        "base",
        "drawer",
        np.eye(4),
        np.array([0.0, -1.0, 0.0]),
        0.0,
        travel_m,
        damping=6.0,
        friction=friction,
    )
    robot = RobotModel("cabinet_test", (carcass(density), drawer), (joint,))
    return model_of(robot, [Handle("drawer_joint", "drawer", np.array([0.0, -y, 0.0]))])


def wheel_model(arm_m: float = 0.1) -> CadModel:
    """A carcass with a wheel on top that turns without end about z, pulled ``arm_m`` off."""
    z = SIZE[2] / 2
    wheel = solid_link("wheel", ((-0.1, 0.1), (-0.1, 0.1), (0.003, 0.02)))
    joint = Joint(
        "wheel_joint",
        "continuous",
        "base",
        "wheel",
        transform(0, 0, z),
        np.array([0.0, 0, 1]),
        damping=0.05,
        friction=0.05,
    )
    robot = RobotModel("cabinet_test", (carcass(), wheel), (joint,))
    return model_of(robot, [Handle("wheel_joint", "wheel", np.array([arm_m, 0.0, 0.01]))])


def with_link(model: CadModel, name: str, **changes) -> CadModel:
    """The model with one link changed."""
    links = tuple(
        dataclasses.replace(link, **changes) if link.name == name else link
        for link in model.robot.links
    )
    robot = dataclasses.replace(model.robot, links=links)
    return dataclasses.replace(model, load_robot=held(robot))


def with_joint(model: CadModel, **changes) -> CadModel:
    """The model with its only joint changed."""
    joint = dataclasses.replace(model.robot.joints[0], **changes)
    robot = dataclasses.replace(model.robot, joints=(joint,))
    return dataclasses.replace(
        model,
        load_robot=held(robot),
        moving_joints=tuple(j.name for j in robot.moving_joints),
    )
