"""Physical check: supports, layout, collisions, min-conflicts, re-seating, reasons."""

from __future__ import annotations

import dataclasses
import itertools

import jax.numpy as jnp
import numpy as np
import pytest

from isr_jax.config import ExportSettings, PhysicalCheckSettings, StabilitySettings
from isr_jax.errors import LibraryError
from isr_jax.export import export_scene
from isr_jax.geometry import (
    box_at,
    convex_part,
    depth_inside,
    footprint_corners,
    moved_part,
    penetration,
)
from isr_jax.library import CadLibrary
from isr_jax.physical_check import check, check_scenes, contact_ratio, min_conflicts
from isr_jax.physical_check.things import depth_between, scan_points, solid_of
from isr_jax.stability import settle
from isr_jax.types import ROOM, UNSUPPORTED, Alignments, AlignmentStatus, Shortlist

from .builders import (
    box_entity,
    box_mesh,
    floor_entity,
    library_of,
    parts_model,
    rotation_z,
    scene_of,
    support_graph,
    with_robot,
    without_hulls,
)
from .furniture import chair_model
from .reference import physical_check_reference as reference

SETTINGS = PhysicalCheckSettings(max_nudge_m=0.0)
NUDGING = PhysicalCheckSettings()

TABLE = parts_model("table/plain", "table", [((1.0, 0.6, 0.7), (0, 0, 0))])
SLIM = parts_model("table/slim", "table", [((0.5, 0.6, 0.7), (0, 0, 0))])
HIGH = parts_model("table/high", "table", [((1.0, 0.6, 0.75), (0, 0, 0))])
CUP = parts_model("cup/plain", "cup", [((0.1, 0.1, 0.1), (0, 0, 0))])
CHAIR = chair_model("chair/backed")
BAG = parts_model("bag/thick", "bag", [((0.3, 0.3, 0.3), (0, 0, 0))])
FLAT_BAG = parts_model("bag/thin", "bag", [((0.3, 0.15, 0.3), (0, 0, 0))])
LIBRARY = library_of(TABLE, SLIM, HIGH, CUP, CHAIR, BAG, FLAT_BAG)


@dataclasses.dataclass
class Try:
    """One row of a shortlist with its alignment."""

    entity: int
    model: object
    center: tuple[float, float, float]
    error_m: float = 0.02
    yaw: float = 0.0
    scale: float = 1.0
    status: int = AlignmentStatus.CONVERGED
    matching_error: float = 0.0


def run(entities, parents, tries, settings=SETTINGS, library=LIBRARY):
    entities = scene_of(*entities)
    graph = support_graph(entities, parents)
    return check(entities, graph, *candidates(tries, library), library, settings)


def candidates(tries, library=LIBRARY):
    """Shortlist and alignments of the tries."""
    ids = [model.id for model in library.models]
    count = len(tries)
    T = np.tile(np.eye(4, dtype=np.float32), (count, 1, 1))
    for i, t in enumerate(tries):
        T[i, :3, :3], T[i, :3, 3] = rotation_z(t.yaw), t.center
    shortlist = Shortlist(
        np.array([t.entity for t in tries], np.int32),
        np.array([ids.index(t.model.id) for t in tries], np.int32),
        np.zeros(count, np.int32),
        np.array([t.matching_error for t in tries], np.float32),
        np.zeros((count, 4), np.int32),
    )
    alignments = Alignments(
        np.array([t.scale for t in tries], np.float32),
        np.array([t.yaw for t in tries], np.float32),
        T[:, :3, 3],
        T,
        np.zeros(count, np.float32),
        np.array([t.status for t in tries], np.int32),
        np.array([t.error_m for t in tries], np.float32),
    )
    return shortlist, alignments


def table_at(id, x, y=0.0):
    return box_entity(id, "table", (x, y, 0.35), (1.0, 0.6, 0.7))


def reasons(placement):
    return [c.reason for c in placement.candidates]


# Choosing


def test_the_smallest_error_is_taken_where_nothing_conflicts():
    tries = [Try(1, TABLE, (0, 0, 0.35), 0.05), Try(1, SLIM, (0, 0, 0.35), 0.03)]
    floor, table = run([floor_entity(), table_at(2, 0)], [ROOM, 0], tries)
    assert (floor.cad_id, floor.reason) == (None, "layout")
    assert table.cad_id == "table/slim" and table.reason is None
    assert reasons(table) == ["not needed: cost 0.050 m, the chosen one 0.030 m", None]
    bottom = table.T_world_cad[2, 3] - 0.35
    # Nothing may start inside the floor: it stands a hair above it.
    np.testing.assert_allclose(bottom, SETTINGS.clearance_m, atol=1e-7)


def test_near_ties_of_ae_go_to_the_better_match_and_to_true_size():
    entities = [floor_entity(), table_at(2, 0)]
    better = [
        Try(1, TABLE, (0, 0, 0.35), 0.020, matching_error=0.5),
        Try(1, SLIM, (0, 0, 0.35), 0.022, matching_error=0.1),
    ]
    true_size = [Try(1, TABLE, (0, 0, 0.28), 0.020, scale=0.8), Try(1, SLIM, (0, 0, 0.35), 0.022)]
    paper = dataclasses.replace(SETTINGS, matching_weight_m=0.0, scale_weight_m=0.0)
    for tries in (better, true_size):
        assert run(entities, [ROOM, 0], tries)[1].cad_id == "table/slim"
        assert run(entities, [ROOM, 0], tries, paper)[1].cad_id == "table/plain"


def test_overlapping_models_give_way_to_an_alternative():
    tries = [
        Try(1, TABLE, (0, 0, 0.35), 0.01),
        Try(2, TABLE, (0.9, 0, 0.35), 0.02),
        Try(2, SLIM, (0.9, 0, 0.35), 0.05),
    ]
    _, one, two = run([floor_entity(), table_at(2, 0), table_at(3, 0.9)], [ROOM, 0, 0], tries)
    assert (one.cad_id, two.cad_id) == ("table/plain", "table/slim")
    assert reasons(two) == ["collides with table_2 by 0.100 m", None]


def test_where_nothing_fits_the_worse_one_keeps_its_scan_and_says_why():
    tries = [Try(1, TABLE, (0, 0, 0.35), 0.03), Try(2, TABLE, (0.9, 0, 0.35), 0.02)]
    _, one, two = run([floor_entity(), table_at(2, 0), table_at(3, 0.9)], [ROOM, 0, 0], tries)
    assert two.cad_id == "table/plain" and one.cad_id is None
    assert one.T_world_cad is None
    assert reasons(one) == ["collides with table_3 by 0.100 m"]
    assert one.reason == "no candidate of 1 fits; table/plain: collides with table_3 by 0.100 m"


def test_a_model_wholly_inside_another_collides():
    """A cup in a solid table: triangle meshes would not touch."""
    cup = box_entity(3, "cup", (0, 0, 0.3), (0.1, 0.1, 0.1))
    tries = [Try(1, TABLE, (0, 0, 0.35), 0.01), Try(2, CUP, (0, 0, 0.3), 0.02)]
    _, table, placed = run([floor_entity(), table_at(2, 0), cup], [ROOM, 0, UNSUPPORTED], tries)
    assert table.cad_id is not None and placed.cad_id is None
    assert "collides with table_2 by 0.3" in placed.candidates[0].reason


def test_small_overlaps_are_nudged_away_and_larger_ones_are_not():
    scene = [floor_entity(), table_at(2, 0), table_at(3, 0.98)]
    tries = [Try(1, TABLE, (0, 0, 0.35), 0.01), Try(2, TABLE, (0.98, 0, 0.35), 0.02)]
    _, one, two = run(scene, [ROOM, 0, 0], tries, NUDGING)
    assert one.cad_id == two.cad_id == "table/plain"
    np.testing.assert_allclose(one.T_world_cad[0, 3], 0.0, atol=1e-7)  # the better one stays
    np.testing.assert_allclose(two.T_world_cad[0, 3], 1.0, atol=1e-3)
    tries[1] = dataclasses.replace(tries[1], center=(0.9, 0, 0.35))
    _, one, two = run(scene, [ROOM, 0, 0], tries, NUDGING)
    assert two.cad_id is None


def test_a_small_overlap_does_not_cost_the_better_model():
    """2 cm that a nudge ends weigh less than 8 cm of alignment error."""
    scene = [floor_entity(), table_at(2, 0), table_at(3, 0.98)]
    tries = [
        Try(1, TABLE, (0, 0, 0.35), 0.01),
        Try(2, TABLE, (0.98, 0, 0.35), 0.02),
        Try(2, SLIM, (0.98, 0, 0.35), 0.1),
    ]
    assert run(scene, [ROOM, 0, 0], tries, NUDGING)[2].cad_id == "table/plain"
    tries[2] = dataclasses.replace(tries[2], error_m=0.03)
    assert run(scene, [ROOM, 0, 0], tries, NUDGING)[2].cad_id == "table/slim"


def test_what_moves_yields_to_what_stands():
    """A cup reaches into a table that fits worse: the cup keeps its scan."""
    cup = box_entity(3, "cup", (0.5, 0, 0.3), (0.1, 0.1, 0.1))
    tries = [Try(1, TABLE, (0, 0, 0.35), 0.09), Try(2, CUP, (0.5, 0, 0.3), 0.001)]
    _, table, kept = run([floor_entity(), table_at(2, 0), cup], [ROOM, 0, UNSUPPORTED], tries)
    assert table.cad_id is not None and kept.cad_id is None


def test_nothing_is_nudged_into_a_wall():
    scene = [floor_entity(), table_at(2, 0), table_at(3, 0.98), _wall(1.48)]
    tries = [Try(1, TABLE, (0, 0, 0.35), 0.01), Try(2, TABLE, (0.98, 0, 0.35), 0.02)]
    _, one, two, _ = run(scene, [ROOM, 0, 0, ROOM], tries, NUDGING)
    # The worse one stands at the wall, so the better one goes.
    np.testing.assert_allclose(two.T_world_cad[0, 3], 0.98, atol=1e-6)
    np.testing.assert_allclose(one.T_world_cad[0, 3], -0.02, atol=1e-3)
    scene.append(box_entity(10, "wall", (-0.55, 0, 1.25), (0.1, 4, 2.5), faces=(2,)))
    _, one, two, *_ = run(scene, [ROOM, 0, 0, ROOM, ROOM], tries, NUDGING)
    assert one.cad_id == "table/plain" and two.cad_id is None


def test_a_kept_scan_counts():
    """A cushion has no model; a candidate through it loses to one beside it."""
    cushion = box_entity(3, "cushion", (0.45, 0, 0.2), (0.3, 0.3, 0.4))
    tries = [Try(1, TABLE, (0, 0, 0.35), 0.01), Try(1, SLIM, (0, 0, 0.35), 0.05)]
    _, table, kept = run([floor_entity(), table_at(2, 0), cushion], [ROOM, 0, 0], tries)
    assert kept.reason == "class cushion has no CAD function"
    assert table.cad_id == "table/slim"
    assert reasons(table)[0].startswith("collides with cushion_3")
    _, alone, _ = run([floor_entity(), table_at(2, 0), cushion], [ROOM, 0, 0], tries[:1])
    assert alone.cad_id is None and "cushion_3" in alone.reason


# Supports


def _cup_on_table(x, z=0.7):
    return box_entity(3, "cup", (x, 0, z + 0.05), (0.1, 0.1, 0.1))


def test_a_candidate_that_does_not_carry_a_child_is_dropped():
    tries = [Try(1, SLIM, (0, 0, 0.35), 0.01), Try(1, TABLE, (0, 0, 0.35), 0.05)]
    scene = [floor_entity(), table_at(2, 0), _cup_on_table(0.27)]
    _, table, _ = run(scene, [ROOM, 0, 1], tries)
    assert table.cad_id == "table/plain"
    assert reasons(table)[0] == "carries cup_3 with A = 0.30 (< 0.5)"


def test_a_candidate_without_a_plane_near_the_child_is_dropped():
    low = Try(1, TABLE, (0, 0, 0.28), 0.01, scale=0.8)
    _, table, _ = run([floor_entity(), table_at(2, 0), _cup_on_table(0)], [ROOM, 0, 1], [low])
    assert reasons(table) == ["has no plane within 0.10 m of cup_3's bottom"]


def test_children_move_onto_the_model_of_their_parent():
    """The model is 5 cm higher than the scan: cup and all are lifted."""
    tries = [Try(1, HIGH, (0, 0, 0.375), 0.01), Try(2, CUP, (0, 0, 0.75), 0.01)]
    _, table, cup = run([floor_entity(), table_at(2, 0), _cup_on_table(0)], [ROOM, 0, 1], tries)
    top = table.T_world_cad[2, 3] + 0.375
    np.testing.assert_allclose(cup.T_world_cad[2, 3] - 0.05, top + SETTINGS.clearance_m, atol=1e-6)


def _bag_on_chair():
    """A bag on a seat at 0.48 m, seen 6 cm nearer to the back than its model has room for."""
    chair = box_entity(2, "chair", (0, 0, 0.44), (0.44, 0.44, 0.88))
    bag = box_entity(3, "bag", (0, 0.05, 0.63), (0.3, 0.3, 0.3))
    return [floor_entity(), chair, bag], [ROOM, 0, 1], [_seat(), Try(2, BAG, (0, 0.074, 0.63))]


def _seat():
    return Try(1, CHAIR, (0, 0, 0.44))


def _in_the_back_m(placed):
    """How far a placed bag reaches into the back of the chair."""
    size_y = 0.3 if placed.cad_id == "bag/thick" else 0.15
    return placed.T_world_cad[1, 3] + size_y / 2 - 0.18


def test_a_bag_is_moved_out_of_the_back_of_its_chair():
    entities, parents, tries = _bag_on_chair()
    _, chair, bag = run(entities, parents, tries, NUDGING)
    assert (chair.cad_id, bag.cad_id) == ("chair/backed", "bag/thick")
    assert abs(chair.T_world_cad[1, 3]) < 1e-6, "what carries it stays"
    assert -1e-3 < _in_the_back_m(bag) <= 0
    assert bag.T_world_cad[2, 3] - 0.15 == pytest.approx(0.48, abs=1e-3)


def test_where_no_small_move_frees_a_child_another_candidate_does():
    entities, parents, tries = _bag_on_chair()
    tries.append(Try(2, FLAT_BAG, (0, 0.074, 0.63), 0.05))
    _, chair, bag = run(entities, parents, tries)
    assert (chair.cad_id, bag.cad_id) == ("chair/backed", "bag/thin")
    assert _in_the_back_m(bag) < 0
    assert reasons(bag)[0] == "collides with chair_2 by 0.044 m"


def test_a_child_that_fits_nowhere_does_not_cost_its_carrier_the_model():
    entities, parents, tries = _bag_on_chair()
    tries[0] = dataclasses.replace(tries[0], error_m=0.09)  # the bag alone fits better
    _, chair, bag = run(entities, parents, tries)
    assert chair.cad_id == "chair/backed" and bag.cad_id is None
    assert bag.reason == "no candidate of 1 fits; bag/thick: collides with chair_2 by 0.044 m"


def test_a_scan_does_not_cost_its_carrier_the_model_either():
    """Export cuts it where it reaches into the back."""
    entities, parents, tries = _bag_on_chair()
    entities[2] = box_entity(3, "bag", (0, 0.08, 0.63), (0.3, 0.3, 0.3))
    _, chair, bag = run(entities, parents, tries[:1])
    assert chair.cad_id == "chair/backed" and bag.cad_id is None


@pytest.mark.parametrize("kept", [False, True])
@pytest.mark.parametrize("checked", [False, True])
def test_a_bag_on_a_chair_stands_in_mujoco(tmp_path, checked, kept):
    """Also where nobody looked before export: it pushes the model out, and cuts the scan."""
    items, parents, tries = _bag_on_chair()
    entities = scene_of(*items)
    graph = support_graph(entities, parents)
    nudging = NUDGING if checked else dataclasses.replace(NUDGING, penetration_tolerance_m=1.0)
    tries = tries[:1] if kept else tries
    placements = check(entities, graph, *candidates(tries), LIBRARY, nudging)
    if not kept:
        assert (_in_the_back_m(placements[2]) > 0.04) == (not checked)
    scene = export_scene(entities, graph, placements, LIBRARY, tmp_path, ExportSettings())
    assert scene.metrics["export"]["unresolved"] == {}
    report = settle(tmp_path / "scene.xml", StabilitySettings(duration_s=2.0, perturbed_resets=0))
    assert report.exported.penetration_max_m < 1e-4
    drift_m = {body.name: body.drift_end_m for body in report.exported.bodies}
    assert set(drift_m) == {"chair_2", "bag_3"} and max(drift_m.values()) < 1e-3


# Hulls: what is judged is what is written


def grown(model, margin_m, method):
    """The model with hulls that reach beyond its surface on all sides, and say so."""
    links = []
    for link in model.robot.links:
        hulls = [
            dataclasses.replace(mesh, vertices=mesh.vertices + margin_m * np.sign(mesh.vertices))
            for mesh in (visual.mesh for visual in link.visuals)
        ]
        links.append(dataclasses.replace(link, hulls=tuple(hulls)))
    made = with_robot(model, dataclasses.replace(model.robot, links=tuple(links)))
    return dataclasses.replace(made, collision=method, swelling_m=1.75 * margin_m)


class HullMaker:
    """Quick hulls reach 10 cm too far, by 17.5 cm at corners; slow ones are exact."""

    def __init__(self):
        self.asked = []

    def __call__(self, models, method):
        self.asked.append((method, [model.id for model in models]))
        return [grown(m, 0.1 if method == "vhacd" else 0.0, method) for m in models]


def imported(maker):
    models = tuple(without_hulls(model) for model in LIBRARY.models)
    return CadLibrary(models, "imported", "hash", maker)


def test_models_that_clash_by_hulls_that_are_not_written_stand():
    scene = [floor_entity(size=(9, 9)), table_at(2, 0), table_at(3, 1.05)]
    tries = [
        Try(1, TABLE, (0, 0, 0.35)),
        Try(2, TABLE, (1.05, 0, 0.35)),
        Try(2, SLIM, (1.05, 0, 0.35), 0.05),
    ]
    maker = HullMaker()
    _, one, two = run(scene, [ROOM, 0, 0], tries, library=imported(maker))
    assert one.cad_id == two.cad_id == "table/plain"
    for placed, x in ((one, 0.0), (two, 1.05)):
        # At rest on the hulls that are written; the others reach 10 cm lower.
        np.testing.assert_allclose(placed.T_world_cad[:3, 3], [x, 0, 0.3502], atol=1e-6)
    assert maker.asked == [("vhacd", ["table/plain", "table/slim"]), ("coacd", ["table/plain"])]


def test_a_clash_of_the_hulls_that_are_written_counts():
    """By the quick hulls it is not certain: they overlap by less than they may swell."""
    scene = [floor_entity(size=(9, 9)), table_at(2, 0), table_at(3, 0.94)]
    tries = [
        Try(1, TABLE, (0, 0, 0.35)),
        Try(2, TABLE, (0.94, 0, 0.35)),
        Try(2, SLIM, (0.94, 0, 0.35), 0.05),
    ]
    maker = HullMaker()
    library = imported(maker)
    _, one, two = run(scene, [ROOM, 0, 0], tries, library=library)
    assert (one.cad_id, two.cad_id) == ("table/plain", "table/slim")
    assert reasons(two)[0] == "collides with table_2 by 0.060 m"
    assert [ids for method, ids in maker.asked if method == "coacd"] == [
        ["table/plain"],
        ["table/slim"],
    ]
    # Export asks the library for the same hulls.
    chosen = [library.position(p.cad_id) for p in (one, two)]
    written = library.with_hulls(chosen, "coacd")
    assert [written[i].swelling_m for i in chosen] == [0.0, 0.0]


def test_what_is_certain_by_quick_hulls_costs_no_slow_ones():
    """40 cm deep, and 35 cm of it may be swelling."""
    scene = [floor_entity(size=(9, 9)), table_at(2, 0), table_at(3, 0.6)]
    tries = [
        Try(1, TABLE, (0, 0, 0.35)),
        Try(2, HIGH, (0.6, 0, 0.35)),
        Try(2, SLIM, (0.8, 0, 0.35), 0.09),
    ]
    maker = HullMaker()
    _, one, two = run(scene, [ROOM, 0, 0], tries, NUDGING, library=imported(maker))
    assert (one.cad_id, two.cad_id) == ("table/plain", "table/slim")
    assert "table/high" not in [i for method, ids in maker.asked for i in ids if method == "coacd"]


def test_a_library_that_makes_no_hulls_says_which_model_lacks_them():
    tries = [Try(1, TABLE, (0, 0, 0.35))]
    with pytest.raises(LibraryError, match="table/plain of imported has no collision hulls"):
        run([floor_entity(), table_at(2, 0)], [ROOM, 0], tries, library=imported(None))


def test_scenes_are_checked_one_by_one():
    tries = [Try(1, TABLE, (0, 0, 0.35))]
    entities = [scene_of(floor_entity(), table_at(2, x)) for x in (0.0, 0.1)]
    graphs = [support_graph(of_one, [ROOM, 0]) for of_one in entities]
    shortlist, alignments = candidates(tries)
    found = check_scenes(entities, graphs, [shortlist] * 2, [alignments] * 2, LIBRARY, SETTINGS)
    assert [p[1].cad_id for p in found] == ["table/plain"] * 2


# Layout


def _wall(x):
    """A wall at ``x`` that looks towards -x."""
    return box_entity(9, "wall", (x + 0.05, 0, 1.25), (0.1, 4, 2.5), faces=(3,))


def test_a_candidate_deep_in_a_wall_is_dropped_and_a_shallow_one_leaves_it():
    scene = [floor_entity(), table_at(2, 0), _wall(0.2)]
    _, table, _ = run(scene, [ROOM, 0, ROOM], [Try(1, TABLE, (0, 0, 0.35))])
    assert reasons(table) == ["penetrates wall_9 by 0.30 m"]
    scene[2] = _wall(0.45)
    _, table, _ = run(scene, [ROOM, 0, ROOM], [Try(1, TABLE, (0, 0, 0.35))])
    np.testing.assert_allclose(table.T_world_cad[0, 3], -0.05 - SETTINGS.clearance_m, atol=1e-6)


def test_a_wall_beside_and_a_room_behind_do_not_count():
    beside = box_entity(9, "wall", (0.25, 5, 1.25), (0.1, 4, 2.5), faces=(3,))
    _, table, _ = run(
        [floor_entity(), table_at(2, 0), beside], [ROOM, 0, ROOM], [Try(1, TABLE, (0, 0, 0.35))]
    )
    assert table.cad_id is not None
    _, table, _ = run(
        [floor_entity(), table_at(2, 0), _wall(-1)], [ROOM, 0, ROOM], [Try(1, TABLE, (0, 0, 0.35))]
    )
    assert table.cad_id is not None


# Reasons


def test_every_way_to_keep_a_scan_is_named():
    scene = [
        floor_entity(),
        table_at(2, 0),
        box_entity(3, "sofa", (3, 0, 0.4), (1, 1, 0.8)),
        box_entity(4, "cup", (1, 1, 0.05), (0.1, 0.1, 0.1)),
    ]
    tries = [
        Try(1, TABLE, (0, 0, 0.35), 0.21),
        Try(1, SLIM, (0, 0, 0.35), 0.3, status=AlignmentStatus.NOT_CONVERGED),
        Try(1, SLIM, (0, 0, 0.35), 0.4, status=AlignmentStatus.SINGULAR),
    ]
    _, table, sofa, cup = run(scene, [ROOM, 0, 0, 0], tries)
    assert reasons(table) == [
        "AE 0.210 m over 0.100 m",
        "alignment: not converged",
        "alignment: singular",
    ]
    assert table.reason == "no candidate of 3 fits; table/plain: AE 0.210 m over 0.100 m"
    assert sofa.reason == "no model of class sofa in the library"
    assert cup.reason == "matching found no candidate"


def test_the_same_seed_gives_the_same_scene_and_order_of_scale_is_kept():
    scene = [floor_entity(size=(9, 9)), *[table_at(i + 2, 0.8 * i) for i in range(4)]]
    tries = [
        Try(i + 1, model, (0.8 * i, 0, 0.35), 0.01 * (k + 1) + 0.001 * i)
        for i in range(4)
        for k, model in enumerate((TABLE, SLIM))
    ]
    first = run(scene, [ROOM, 0, 0, 0, 0], tries)
    again = run(scene, [ROOM, 0, 0, 0, 0], tries)
    assert [p.cad_id for p in first] == [p.cad_id for p in again]
    chosen = [p.cad_id for p in first[1:]]
    # At 0.8 m two plain ones (1 m) overlap, a plain and a slim one (0.75 m) do not.
    assert None not in chosen
    assert not any(a == b == "table/plain" for a, b in itertools.pairwise(chosen))


# Kernels


@pytest.mark.parametrize("seed", range(20))
def test_min_conflicts_finds_as_few_as_there_can_be(seed):
    rng = np.random.default_rng(seed)
    count, options = 5, 4
    errors = [rng.uniform(0, 0.1, options) for _ in range(count)]
    depths = rng.uniform(0.01, 0.2, (count, options, count, options))
    depths *= rng.random(depths.shape) < (0.35 if seed % 2 else 0.6)
    depths = depths + depths.transpose(2, 3, 0, 1)
    neighbours = [[j for j in range(count) if j != i] for i in range(count)]

    def conflict(i, a, j, b):
        return float(depths[i, a, j, b])

    chosen = min_conflicts(errors, neighbours, conflict, tolerance_m=0.0, max_rounds=300, seed=0)
    found = sum(conflict(i, chosen[i], j, chosen[j]) > 0 for i in range(count) for j in range(i))
    assert found == reference.best_choice(errors, neighbours, conflict)


def _random_part(rng, count=12):
    return convex_part(rng.normal(0, 0.3, (count, 3)) + rng.normal(0, 0.2, 3))


@pytest.mark.parametrize("seed", range(12))
def test_penetration_parity_with_the_minkowski_hull(seed):
    rng = np.random.default_rng(seed)
    a, b = _random_part(rng), _random_part(rng)
    depth, direction = penetration(a, b)
    np.testing.assert_allclose(depth, reference.penetration(a.vertices, b.vertices), atol=1e-6)
    if depth > 0:
        T = np.eye(4)
        T[:3, 3] = direction * (depth + 1e-5)
        assert penetration(moved_part(a, T), b)[0] == 0.0


def test_the_depth_of_solids_is_that_of_their_parts():
    rng = np.random.default_rng(1)
    seen = set()
    for _ in range(60):
        a, b = _random_part(rng, 8), _random_part(rng, 8)
        expected = reference.penetration(a.vertices, b.vertices)
        if abs(expected) < 1e-6 and expected != 0:
            continue
        got = depth_between(solid_of((a,), np.eye(4), 1.0), solid_of((b,), np.eye(4), 1.0))
        np.testing.assert_allclose(got, expected, atol=1e-6)
        seen.add(expected > 0)
    assert seen == {True, False}


def test_a_contained_part_has_the_depth_to_the_nearest_face():
    outer = convex_part(box_mesh((1, 1, 1), spacing_m=1).vertices)
    inner = convex_part(box_mesh((0.1, 0.1, 0.1), (0.2, 0, 0), spacing_m=1).vertices)
    np.testing.assert_allclose(penetration(inner, outer)[0], 0.35, atol=1e-6)
    np.testing.assert_allclose(
        depth_inside(outer, np.array([[0.2, 0, 0], [1, 0, 0]])), [0.3, -0.5], atol=1e-6
    )


def test_stray_points_of_a_scan_are_forgiven():
    solid = solid_of((convex_part(box_mesh((1, 1, 1), spacing_m=1).vertices),), np.eye(4), 1.0)
    outside = np.tile([0.0, 0.0, 2.0], (500, 1))
    few = np.concatenate([outside, np.zeros((5, 3))])
    many = np.concatenate([outside, np.zeros((50, 3))])
    assert depth_between(solid, scan_points(few)) == 0.0
    np.testing.assert_allclose(depth_between(solid, scan_points(many)), 0.5, atol=1e-6)


@pytest.mark.parametrize("yaw", [0.0, 0.3, 0.8])
def test_contact_ratio_parity_with_counting(yaw):
    entities = scene_of(
        box_entity(1, "table", (0.1, 0.2, 0), (1, 0.6, 1), 0.2),
        box_entity(2, "cup", (0.5, 0.3, 0), (0.4, 0.3, 1), yaw),
    )
    boxes = support_graph(entities, [ROOM, ROOM]).refined_box
    plane, footprint = (np.asarray(footprint_corners(box_at(boxes, i))) for i in (0, 1))
    got = contact_ratio(plane, footprint, jnp.asarray(0.12))
    # A grid of 400 x 400 counts to about its own spacing.
    np.testing.assert_allclose(got, reference.contact_ratio(plane, footprint), atol=5e-3)
