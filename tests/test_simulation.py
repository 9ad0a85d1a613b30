"""The MuJoCo layer: contacts, settling, pushing, drawing."""

from __future__ import annotations

import cv2
import mujoco
import numpy as np
import pytest

from isr_jax.borders import simulation
from isr_jax.borders.drawing import draw_scene
from isr_jax.errors import OutputError, SceneError
from isr_jax.robot_model.mjcf import ContactModel

GRAVITY = 9.81


def scene(tmp_path, *bodies: str, option: str = "") -> mujoco.MjModel:
    """A floor box below z = 0 and the given bodies."""
    contact = ContactModel()
    solimp = " ".join(map(str, contact.solimp))
    text = f"""<mujoco><option timestep="0.002" cone="elliptic" impratio="10" {option}/>
    <default><geom solref="{contact.solref[0]} 1" solimp="{solimp}" friction="0.8"/></default>
    <worldbody><body name="floor" pos="0 0 -0.05"><geom type="box" size="3 3 0.05"/></body>
    {"".join(bodies)}</worldbody></mujoco>"""
    path = tmp_path / "scene.xml"
    path.write_text(text)
    return simulation.load_model(path)


def cube(name: str, x: float, z: float, mass: float = 1.0, half: float = 0.1) -> str:
    return (
        f'<body name="{name}" pos="{x} 0 {z}"><freejoint/>'
        f'<geom type="box" size="{half} {half} {half}" mass="{mass}"/></body>'
    )


def test_overlap_is_reported_with_its_depth(tmp_path):
    model = scene(tmp_path, cube("a", 0, 0.1), cube("b", 0.19, 0.1), cube("c", 1, 0.097))
    found = {(t.body_a, t.body_b): t.depth_m for t in simulation.touches(model)}
    assert np.isclose(found["a", "b"], 0.01, atol=1e-6)
    assert np.isclose(found["floor", "c"], 0.003, atol=1e-6)
    deepest = simulation.touches(model)[0]
    assert (deepest.body_a, deepest.body_b) == ("a", "b") and deepest.contacts >= 1


def test_falling_follows_gravity(tmp_path):
    path = simulation.simulate(scene(tmp_path, cube("a", 0, 2.0)), 0.5, 0.1)
    fallen = path.position_m[0, 0, 2] - path.position_m[:, 0, 2]
    # semi-implicit steps overshoot g t^2 / 2 by g t dt / 2
    expected = GRAVITY * path.time_s * (path.time_s + 0.002) / 2
    assert np.allclose(fallen, expected, atol=1e-6)


def test_a_heavy_stack_sinks_less_than_half_a_millimetre(tmp_path):
    model = scene(tmp_path, cube("a", 0, 0.1), cube("b", 0, 0.3), cube("c", 0, 0.5, mass=50.0))
    path = simulation.simulate(model, 3.0)
    drift = np.linalg.norm(path.position_m[-1] - path.position_m[0], axis=-1)
    assert np.all(drift < 5e-4) and not path.warnings


def test_simulation_repeats_exactly(tmp_path):
    model = scene(tmp_path, cube("a", 0, 0.5), cube("b", 0.05, 0.8))
    first, second = (simulation.simulate(model, 1.0) for _ in range(2))
    assert np.array_equal(first.position_m, second.position_m)
    assert np.array_equal(first.quaternion, second.quaternion)


def test_a_push_moves_what_friction_does_not_hold(tmp_path):
    moved = {}
    for force in (5.0, 12.0):  # friction of 1 kg holds 0.8 * 9.81 N = 7.8 N
        model = scene(tmp_path, cube("a", 0, 0.1))
        data = mujoco.MjData(model)
        low = np.array([0.0, 0, -0.08])
        simulation.push(model, data, "a", np.array([force, 0, 0]), low, 0.5)
        moved[force] = data.body("a").xpos[0]
    # a hair of creep remains in soft friction; (12 - 7.8) / 1 * 0.5^2 / 2 = 0.52 m
    assert abs(moved[5.0]) < 1e-3
    assert np.isclose(moved[12.0], (12 - 0.8 * GRAVITY) * 0.5**2 / 2, rtol=0.1)


def door(blocked: bool) -> str:
    block = '<geom name="block" type="box" size="0.02 0.02 0.2" pos="0.3 0.3 0.5"/>'
    return f"""<body name="frame">{block if blocked else ""}
    <body name="leaf" pos="0 0 0.5"><joint name="hinge" axis="0 0 1" range="0 90"
    limited="true" damping="0.1" frictionloss="0.2"/>
    <geom type="box" size="0.25 0.01 0.2" pos="0.27 0 0" mass="5"/></body></body>"""


def test_joint_travel_reaches_both_ends(tmp_path):
    travel = simulation.joint_travel(scene(tmp_path, door(blocked=False)), "hinge")
    assert np.allclose(travel.limits, [0, np.pi / 2])
    assert travel.share > 0.99


def test_a_blocked_joint_shows(tmp_path):
    # the block's near corner stands at 40 degrees or so: the leaf stops before it
    travel = simulation.joint_travel(scene(tmp_path, door(blocked=True)), "hinge")
    assert 0.2 < travel.share < 0.6


def test_perturbed_start_never_goes_down_and_is_seeded(tmp_path):
    model = scene(tmp_path, cube("a", 0, 0.1), cube("b", 1, 0.1))
    draws = [simulation.perturbed_start(model, np.random.default_rng(s), 0.01) for s in (0, 0, 1)]
    assert np.array_equal(draws[0], draws[1]) and not np.array_equal(draws[0], draws[2])
    assert np.all(draws[0].reshape(2, 7)[:, 2] >= 0.1)
    assert np.allclose(np.linalg.norm(draws[0].reshape(2, 7)[:, 3:], axis=1), 1)


def test_freeing_leaves_the_anchored(tmp_path):
    scene(tmp_path, '<body name="shelf" pos="0 0 1"><geom type="box" size=".1 .1 .1"/></body>')
    freed = simulation.freed_model(tmp_path / "scene.xml", ("floor",))
    assert simulation.free_bodies(freed) == ("shelf",)
    assert simulation.static_bodies(freed) == ("floor",)


def test_bounds_hold_all_geoms(tmp_path):
    low, high = simulation.bounds(scene(tmp_path, cube("a", 0, 2.0)), 0.5)
    assert np.allclose(low, [-3.5, -3.5, -0.6]) and np.allclose(high, [3.5, 3.5, 2.6])


@pytest.mark.parametrize("load", [simulation.load_model, lambda p: simulation.freed_model(p, ())])
def test_bad_files_are_named(tmp_path, load):
    with pytest.raises(SceneError, match=r"nothing\.xml"):
        load(tmp_path / "nothing.xml")
    (tmp_path / "broken.xml").write_text("<mujoco><worldbody><bod/></worldbody></mujoco>")
    with pytest.raises(SceneError, match=r"broken\.xml"):
        load(tmp_path / "broken.xml")


def test_a_picture_shows_the_scene_before_and_after_it_has_moved(tmp_path):
    scene(tmp_path, cube("red", 0, 0.5), "")
    before, after = tmp_path / "before.png", tmp_path / "after.png"
    draw_scene(tmp_path / "scene.xml", before, width=64, height=48)
    draw_scene(tmp_path / "scene.xml", after, after_s=1.0, width=64, height=48)
    images = [cv2.imread(str(path)).astype(int) for path in (before, after)]
    sky = images[0][0, 0]
    assert all((np.abs(image - sky).sum(-1) > 30).any() for image in images)
    with pytest.raises(OutputError, match="png"):
        draw_scene(tmp_path / "scene.xml", tmp_path / "nowhere" / "a.png", width=8, height=8)


NAMELESS = """<mujoco model="flat"><worldbody><geom type="plane" size="3 3 .1"/>
<frame pos="0 0 1"><body><geom type="box" size=".1 .1 .1"/></body></frame>
<body name="gate" pos="1 0 1"><joint axis="0 0 1" range="0 90"/><geom size=".1"/></body>
<body pos="2 0 1"><freejoint/><geom size=".1"/></body>
<body name="target" mocap="true" pos="2 3 1"><geom size=".1"/></body>
<body name="holder" pos="2 5 1"><body><geom size=".1"/></body></body>
<body name="jamb" pos="2 7 1"><body name="leaf"><joint name="leaf"/><geom size=".1"/></body></body>
</worldbody><keyframe><key name="home" qpos="0 2 0 3 1 0 0 0 0"/></keyframe></mujoco>"""


def test_a_scene_of_any_make_is_freed_where_it_can_be():
    """Nameless bodies, mocap, keyframes, joints to the world, mass below a massless body."""
    spec = mujoco.MjSpec.from_string(NAMELESS)
    model = simulation.load_model(spec)
    assert simulation.free_bodies(model) == ("#3",)
    assert simulation.static_bodies(model) == ("#1", "target", "holder", "jamb")
    # the leaf's mass turns on its own joint and does not hold the jamb
    assert simulation.unfreeable_bodies(model) == ("target", "jamb")
    freed = simulation.freed_model(spec, ())
    assert simulation.free_bodies(freed) == ("#1", "#3", "holder")
    assert simulation.moving_joints(freed) == ("#1", "leaf")
    assert (freed.nkey, spec.compile().nkey) == (0, 1), "the given spec is left as it was"
    path = simulation.simulate(model, 0.1)
    assert path.bodies == ("#3",) and path.joints == ("#0", "leaf")
    assert simulation.joint_travel(model, "#0").share > 0.99
    with pytest.raises(SceneError, match="MjModel flat is compiled"):
        simulation.freed_model(model, ())


def test_unknown_names_are_refused(tmp_path):
    model = scene(tmp_path, cube("a", 0, 0.1), door(blocked=False))
    with pytest.raises(SceneError, match=r"no joint is called 'hinges'(.|\n)*hinge"):
        simulation.joint_travel(model, "hinges")
    with pytest.raises(SceneError, match="is no hinge and no slide"):
        simulation.joint_travel(model, "#0")
    with pytest.raises(SceneError, match=r"no body is called 'b'(.|\n)*a, frame, leaf"):
        simulation.push(model, mujoco.MjData(model), "b", np.ones(3), np.zeros(3), 0.1)
