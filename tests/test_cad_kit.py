"""Every model of the kit is sound: solids, masses, planes, joints, symmetry."""

from __future__ import annotations

import collections
import subprocess
import sys
from pathlib import Path

import fcl
import mujoco
import numpy as np
import pytest
import trimesh
import yourdfpy
from scipy.spatial import ConvexHull

from isr_jax.cad import load_library
from isr_jax.cad.kit import KIT, ModelBuilder
from isr_jax.cad.kit.materials import OAK
from isr_jax.cad.kit.solids import box, circle, frustum, tube
from isr_jax.cad_types import CadLibrary, CadModel
from isr_jax.classes import class_named
from isr_jax.robot_model import link_transforms
from isr_jax.types import Mesh

from .conftest import REPOSITORY

GRID_M = 1e-6  # vertices lie on it; a sum of a few roundings stays below three of them
FLAT_M = 3 * GRID_M
SPOTS, SHARE = 200, 0.13  # 200 random spots: a share within 3.7 standard errors
CLEARANCE_M = 0.0019  # 2 mm by design, less rounding and the swing of a door's rear edge

MASS_RANGE_KG = {
    "table": (4, 80),
    "desk": (15, 90),
    "chair": (3, 20),
    "cabinet": (10, 130),
    "wall_cabinet": (7, 45),
    "counter": (25, 360),
    "sofa": (12, 90),
    "bed": (15, 130),
    "fridge": (15, 140),
    "microwave": (9, 22),
    "monitor": (1.5, 25),
    "bookshelf": (10, 70),
    "bin": (0.4, 6),
    "book": (0.1, 2.5),
    "cup": (0.05, 0.6),
}
"""What such things weigh in shops, generously; a worktop of stone alone weighs 150 kg."""
CLASSES = sorted(MASS_RANGE_KG)


@pytest.fixture(scope="module")
def built(tmp_path_factory) -> CadLibrary:
    """The whole kit, freshly built by the command, in a process without checks of shapes."""
    root = tmp_path_factory.mktemp("kit")
    command = [sys.executable, "-m", "isr_jax.cad", str(root)]
    subprocess.run(command, check=True, capture_output=True, cwd=REPOSITORY)
    return load_library(root)


@pytest.fixture(params=CLASSES)
def models(request, built) -> list[CadModel]:
    """All models of one class."""
    return [m for m in built.models if m.class_name == request.param]


def hulls_at_rest(model: CadModel, link: str | None = None) -> list[np.ndarray]:
    """Vertices of hulls in the canonical frame."""
    poses = link_transforms(model.robot)
    return [
        hull.vertices.astype(np.float64) + poses[part.name][:3, 3]
        for part in model.robot.links
        for hull in part.hulls
        if link in (None, part.name)
    ]


def inside_any(points: np.ndarray, hulls: list[np.ndarray]) -> np.ndarray:
    """Which points [n, 3] lie in any convex hull, by Qhull's own half-spaces."""
    inside = np.zeros(len(points), bool)
    for vertices in hulls:
        near = np.all((points >= vertices.min(0)) & (points <= vertices.max(0)), 1) & ~inside
        if near.any():
            equations = ConvexHull(vertices, qhull_options="QJ").equations
            inside[near] = np.all(points[near] @ equations[:, :3].T + equations[:, 3] <= 1e-7, 1)
    return inside


def volume_of(mesh: Mesh) -> float:
    triangles = mesh.vertices.astype(np.float64)[mesh.faces]
    return float(np.linalg.det(triangles).sum() / 6)


def test_committed_library_is_what_the_kit_builds(built):
    """Other process, other hash seed, maybe other machine: the same bytes."""
    fresh, kept = Path(built.source), REPOSITORY / "cad_db"
    files = [
        {p.relative_to(root).as_posix(): p.read_bytes() for p in root.rglob("*") if p.is_file()}
        for root in (fresh, kept)
    ]
    differing = {name for name in files[0] | files[1] if files[0].get(name) != files[1].get(name)}
    assert not differing, "run `python -m isr_jax.cad` to write cad_db again"
    assert sum(map(len, files[1].values())) < 10e6


def test_six_of_each_class(built):
    count = collections.Counter(m.class_name for m in built.models)
    assert set(count) == set(CLASSES) and min(count.values()) >= 6
    assert len(built) == len(KIT) == len({m.id for m in built.models})


def test_hulls_are_closed_convex_and_small(models):
    for model in models:
        for link in model.robot.links:
            for hull in link.hulls:
                v = hull.vertices.astype(np.float64)
                a, b, c = (v[hull.faces[:, k]] for k in range(3))
                area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
                normal = np.cross(b - a, c - a)[area > 1e-9] / area[area > 1e-9, None]
                height = np.einsum("fc,fvc->fv", normal, v[None] - a[area > 1e-9, None])
                assert height.max() < FLAT_M, model.id
                edges = [(f[i], f[(i + 1) % 3]) for f in hull.faces.tolist() for i in range(3)]
                assert len(set(edges)) == len(edges) and {e[::-1] for e in edges} == set(edges)
                assert len(v) <= 64 and volume_of(hull) > 0


def test_visuals_are_the_closed_skin_of_the_hulls(models):
    for model in models:
        for link in model.robot.links:
            for visual in link.visuals:
                skin = trimesh.Trimesh(visual.mesh.vertices, visual.mesh.faces, process=False)
                assert skin.is_watertight and skin.is_winding_consistent, (model.id, visual.name)
            seen = sum(volume_of(v.mesh) for v in link.visuals)
            assert seen == pytest.approx(sum(map(volume_of, link.hulls)), rel=1e-5)


def test_parts_of_a_link_touch_but_do_not_overlap(models):
    """Any two hulls are parted by a plane (separating axes), up to the grid."""
    for model in models:
        for link in model.robot.links:
            vertices = [h.vertices.astype(np.float64) for h in link.hulls]
            for i, a in enumerate(vertices):
                for k in range(i):
                    b = vertices[k]
                    if np.any((a.min(0) > b.max(0)) | (b.min(0) > a.max(0))):
                        continue
                    gap = max(face_gap(link.hulls[i], b), face_gap(link.hulls[k], a))
                    if gap <= -FLAT_M:
                        gap = edge_gap(link.hulls[i], link.hulls[k])
                    assert gap > -FLAT_M, (model.id, link.name, i, k, gap)


def face_gap(hull: Mesh, points: np.ndarray) -> float:
    """Largest height of all points above one of the hull's faces."""
    corners = hull.vertices.astype(np.float64)[hull.faces]
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    large = np.linalg.norm(normal, axis=1) > 1e-9
    normal = normal[large] / np.linalg.norm(normal[large], axis=1, keepdims=True)
    height = np.einsum("fc,fpc->fp", normal, points[None] - corners[large, :1])
    return float(height.min(1).max())


def edge_gap(a: Mesh, b: Mesh) -> float:
    """Largest gap along the products of an edge of each."""
    (va, ea), (vb, eb) = ((m.vertices.astype(np.float64), edge_vectors(m)) for m in (a, b))
    axes = np.cross(ea[:, None], eb[None]).reshape(-1, 3)
    length = np.linalg.norm(axes, axis=1)
    axes = axes[length > 1e-9] / length[length > 1e-9, None]
    pa, pb = va @ axes.T, vb @ axes.T
    return float(np.maximum(pa.min(0) - pb.max(0), pb.min(0) - pa.max(0)).max())


def edge_vectors(mesh: Mesh) -> np.ndarray:
    v = mesh.vertices.astype(np.float64)
    return np.concatenate([v[mesh.faces[:, k]] - v[mesh.faces[:, k - 1]] for k in range(3)])


def test_box_is_that_of_the_body_without_handles(models):
    for model in models:
        vertices = model.mesh.vertices
        low, high = vertices.min(0), vertices.max(0)
        half = model.size / 2
        beyond = np.concatenate([-half - low, high - half])
        assert np.all(beyond > -FLAT_M), model.id
        allowed = np.full(6, FLAT_M)
        if model.articulated:
            allowed[1] = 0.051  # handles stand out to the front
        elif model.class_name == "cup" and model.symmetry == 1:
            allowed[3] = 0.05  # a cup's handle, to +x
        assert np.all(beyond < allowed), (model.id, beyond)


def test_masses_are_those_of_real_things(models):
    for model in models:
        low, high = MASS_RANGE_KG[model.class_name]
        assert low < model.robot.mass_kg < high, (model.id, model.robot.mass_kg)
        for link in model.robot.links:
            moments = np.linalg.eigvalsh(link.inertia)
            assert moments[0] > 0 and moments[0] + moments[1] > moments[2], (model.id, link.name)
            points = np.concatenate([h.vertices for h in link.hulls])
            assert np.all((link.com > points.min(0)) & (link.com < points.max(0)))


@pytest.mark.parametrize(("cad_id", "density"), [("chair/ladder_42", 700), ("bin/square_30", 1050)])
def test_mass_com_and_inertia_against_sampling(built, cad_id, density):
    """Models of one material, against 6e5 random points in their box."""
    model = built.by_id(cad_id)
    rng = np.random.default_rng(0)
    points = rng.uniform(-model.size / 2, model.size / 2, (600_000, 3))
    points = points[inside_any(points, hulls_at_rest(model))]
    weight = density * float(np.prod(model.size, dtype=np.float64)) / 600_000
    com = points.mean(0)
    second = weight * (points - com).T @ (points - com)
    inertia = np.trace(second) * np.eye(3) - second
    link = model.robot.links[0]
    share = 0.03  # about 2e4 points are inside: 0.7 % of standard error
    assert link.mass_kg == pytest.approx(weight * len(points), rel=share)
    np.testing.assert_allclose(link.com, com, atol=share * model.size.max())
    np.testing.assert_allclose(link.inertia, inertia, atol=share * np.trace(inertia))


def test_com_stands_over_the_feet(models):
    for model in models:
        if model.mount == "wall":
            continue
        poses = link_transforms(model.robot)
        mass = [link.mass_kg for link in model.robot.links]
        com = np.average(
            [link.com + poses[link.name][:3, 3] for link in model.robot.links], 0, weights=mass
        )
        points = np.concatenate(hulls_at_rest(model))
        feet = points[points[:, 2] < -model.size[2] / 2 + 1e-4, :2]
        hull = ConvexHull(feet)
        margin = -(hull.equations[:, :2] @ com[:2] + hull.equations[:, 2]).max()
        assert margin > 0.1 * np.sqrt(hull.volume), (model.id, margin)


def test_planes_lie_on_free_surfaces(models):
    """Corners on the plane, turned about the normal; solid below, free above, area as stated."""
    rng = np.random.default_rng(0)
    for model in models:
        planes = model.planes
        everything = hulls_at_rest(model)
        assert planes.valid.all() and len(planes.offset) >= 2
        for k, link in enumerate(model.plane_link):
            normal, corners = planes.normal[k].astype(np.float64), planes.corners[k]
            assert np.linalg.norm(normal) == pytest.approx(1, abs=1e-6)
            assert np.abs(corners @ normal + planes.offset[k]).max() < FLAT_M, model.id
            u, v = corners[1] - corners[0], corners[3] - corners[0]
            assert np.cross(u, v) @ normal > 0
            np.testing.assert_allclose(corners[2], corners[0] + u + v, atol=FLAT_M)
            full = np.linalg.norm(u) * np.linalg.norm(v)
            assert 0 < planes.area_m2[k] <= full * (1 + 1e-4), model.id
            spots = corners[0] + rng.random((SPOTS, 1)) * u + rng.random((SPOTS, 1)) * v
            solid = inside_any(spots - 1e-4 * normal, hulls_at_rest(model, link))
            above = (1e-4, 0.03, 0.079) if model.plane_supporting[k] else (1e-4,)
            for height in above:
                solid &= ~inside_any(spots + height * normal, everything)
            share = np.mean(solid)
            assert share == pytest.approx(planes.area_m2[k] / full, abs=SHARE), (model.id, k)


def test_supporting_planes_face_up_and_are_wide_enough_to_use(models):
    for model in models:
        rows = np.flatnonzero(model.plane_supporting)
        assert len(rows) or model.class_name in ("cup", "monitor"), model.id
        for k in rows:
            corners = model.planes.corners[k]
            sides = np.linalg.norm(corners[[1, 3]] - corners[0], axis=1)
            assert model.planes.normal[k, 2] > 0.9 and sides.min() >= 0.07, (model.id, k)


def supporting_heights(model: CadModel) -> list[float]:
    """Heights above the floor, ascending."""
    z = model.planes.corners[model.plane_supporting, 0, 2] + model.size[2] / 2
    return sorted(np.round(z.astype(np.float64), 3).tolist())


def test_surfaces_that_carry_are_where_they_should_be(built):
    def only(cad_id: str) -> CadModel:
        return built.by_id(cad_id)

    table = only("table/dining_140x80")
    assert supporting_heights(table) == [0.75]
    assert table.planes.area_m2[0] == pytest.approx(1.4 * 0.8)
    round_area = 0.5 * 32 * np.sin(2 * np.pi / 32) * 0.45**2  # a polygon of 32 sides
    assert only("table/round_90").planes.area_m2[0] == pytest.approx(round_area, rel=1e-4)
    assert 0.45 in supporting_heights(only("chair/ladder_42"))
    assert len(supporting_heights(only("bookshelf/tall_80"))) == 7
    assert len(supporting_heights(only("bookshelf/wide_120"))) == 11
    assert 1.85 in supporting_heights(only("fridge/tall_60"))
    assert 0.9 in supporting_heights(only("counter/row_180"))
    assert 0.43 in supporting_heights(only("sofa/seats_2"))
    assert supporting_heights(only("book/novel")) == [0.032]
    assert supporting_heights(only("cup/mug")) == []
    drawers = only("cabinet/base_60_drawers")
    owners = {link for link, s in zip(drawers.plane_link, drawers.plane_supporting) if s}
    assert {"drawer_1", "drawer_2", "drawer_3"} < owners


def test_symmetry_is_the_largest_true_one(models):
    for model in models:
        steps = {1: 1, 2: 2, 4: 4, 0: 16}[model.symmetry]
        assert maps_onto_itself(model.mesh, steps), model.id
        if model.symmetry in (1, 2):
            assert not maps_onto_itself(model.mesh, 2 * steps), model.id


def maps_onto_itself(mesh: Mesh, order: int) -> bool:
    angle = 2 * np.pi / order
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    points = mesh.vertices.astype(np.float64)
    turned = np.column_stack([points[:, :2] @ turn.T, points[:, 2]])
    keys = [{tuple(p) for p in np.round(q * 1e4).astype(int)} for q in (points, turned)]
    near = [
        any((x + i, y + j, z) in keys[0] for i in (-1, 0, 1) for j in (-1, 0, 1))
        for x, y, z in keys[1]
    ]
    return all(near)


def test_classes_that_open_do_open(models):
    for model in models:
        info = class_named(model.class_name)
        assert model.mount == info.mount
        if info.articulated:
            assert model.articulated, model.id
        for joint in model.robot.moving_joints:
            assert joint.lower == 0 < joint.upper and joint.damping > 0 and joint.friction > 0
            poses = [link_transforms(model.robot, {joint.name: q}) for q in (0.0, joint.upper)]
            com = np.append(model.robot.link(joint.child).com, 1)
            closed, opened = ((T[joint.child] @ com)[1] for T in poses)
            assert opened < closed - 0.05, (model.id, joint.name)


def test_moving_parts_keep_clear_of_everything(models):
    """Clearance over the travel of each joint, and with several joints anywhere."""
    rng = np.random.default_rng(0)
    for model in (m for m in models if m.articulated):
        joints = model.robot.moving_joints
        poses = [{}] + [{j.name: j.upper * q} for j in joints for q in (0.03, 0.15, 0.5, 1.0)]
        poses += [{j.name: j.upper * rng.random() for j in joints} for _ in range(4)]
        poses += [{j.name: j.upper * q for j in joints} for q in (0.03, 0.15, 0.5, 1.0)]
        least = min(least_distance(model, q) for q in poses)
        assert least > CLEARANCE_M, (model.id, least)


def least_distance(model: CadModel, positions: dict[str, float]) -> float:
    poses = link_transforms(model.robot, positions)
    links = []
    for link in model.robot.links:
        T = fcl.Transform(poses[link.name][:3, :3], poses[link.name][:3, 3])
        links.append([fcl.CollisionObject(convex(hull), T) for hull in link.hulls])
    return min(
        fcl.distance(a, b)
        for i, first in enumerate(links)
        for second in links[:i]
        for a in first
        for b in second
    )


def convex(hull: Mesh) -> fcl.Convex:
    faces = np.concatenate([np.full((len(hull.faces), 1), 3), hull.faces], 1)
    return fcl.Convex(hull.vertices.astype(np.float64), len(hull.faces), faces.ravel())


def test_mujoco_reads_every_model(built):
    for model in built.models:
        compiled = mujoco.MjModel.from_xml_path(f"{built.source}/{model.id}/model.urdf")
        assert compiled.njnt == len(model.robot.moving_joints), model.id
        assert compiled.body_mass.sum() == pytest.approx(model.robot.mass_kg, rel=1e-6)


# yourdfpy calls what trimesh has renamed.
@pytest.mark.filterwarnings("ignore:.*Scene.dump:DeprecationWarning")
@pytest.mark.parametrize("class_name", CLASSES)
def test_yourdfpy_reads_one_of_each_class(built, class_name):
    model = max(
        (m for m in built.models if m.class_name == class_name), key=lambda m: m.articulated
    )
    urdf = yourdfpy.URDF.load(f"{built.source}/{model.id}/model.urdf")
    assert list(urdf.actuated_joint_names) == [j.name for j in model.robot.moving_joints]
    closed = urdf.scene.bounds
    np.testing.assert_allclose(closed[0], model.mesh.vertices.min(0), atol=FLAT_M)
    np.testing.assert_allclose(closed[1], model.mesh.vertices.max(0), atol=FLAT_M)


def test_builder_puts_the_origin_in_the_middle_and_joins_coplanar_faces():
    builder = ModelBuilder("table", "two_boards", symmetry=1)
    builder.add(OAK, box((0.0, 0.4), (0.0, 0.3), (0.0, 0.02)))
    builder.add(OAK, box((0.404, 0.8), (0.0, 0.3), (0.0, 0.02)))
    builder.add(OAK, box((0.8, 1.0), (0.0, 0.3), (0.0, 0.1)))
    model = builder.build()
    np.testing.assert_allclose(model.size, [1.0, 0.3, 0.1])
    assert supporting_heights(model) == [0.02, 0.1]
    k = int(np.argmax(model.planes.area_m2 * (model.planes.corners[:, 0, 2] < 0)
                      * model.plane_supporting))  # fmt: skip
    # The 4 mm joint belongs to the rectangle, not to the area.
    width = np.ptp(model.planes.corners[k, :, 0])
    assert width == pytest.approx(0.8) and model.planes.area_m2[k] == pytest.approx(0.796 * 0.3)


def test_tubes_are_hollow():
    outer, inner = (np.stack([circle(r), circle(r)]) for r in (0.1, 0.09))
    staves = tube(outer, inner, (0.0, 0.2))
    volume = sum(volume_of(s.mesh()) for s in staves)
    ring = volume_of(frustum((0.1, 0.1), (0.0, 0.2)).mesh())
    hole = volume_of(frustum((0.09, 0.09), (0.0, 0.2)).mesh())
    assert volume == pytest.approx(ring - hole, rel=1e-4)
