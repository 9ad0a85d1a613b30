"""scene.json: what is written is read back the same, and what breaks the schema is refused."""

from __future__ import annotations

import json
from typing import get_args

import numpy as np
import pytest

from isr_jax.errors import SceneError
from isr_jax.scene_file import (
    EntityType,
    read_scene,
    scene_from_stages,
    scene_schema,
    write_scene,
)
from isr_jax.types import ROOM, Attachment, Candidate, Placement

from .builders import box_entity, floor_entity, library_of, scene_of, support_graph, table_model

FLOAT32_RESOLUTION = 1e-6
"""Files keep the shortest decimal that reads back as the same float32."""


@pytest.fixture
def scene():
    entities = scene_of(floor_entity(1), box_entity(2, "table", (1, 0.5, 0.37), (1.2, 0.8, 0.74)))
    proximal = np.array([[0, 1]], np.int32), np.array([0.01], np.float32)
    graph = support_graph(entities, [ROOM, 0], score=[0, 0.9], proximal=proximal)
    T = np.eye(4, dtype=np.float32)
    T[:3, 3] = (1, 0.5, 0.37)
    lost = Candidate("table/other", 3, 0.4, 0.05, "converged", "collides with chair_1 by 0.02 m")
    placements = (
        Placement(1, None, None, None, None, None, (), "layout"),
        Placement(2, "table/test", T, np.full(3, 1.1, np.float32), 0.1, 0.012, (lost,), None),
    )
    library = library_of(table_model())
    return scene_from_stages(
        entities, graph, placements, library, {2: "map/table_2.ply"}, versions={"isr_jax": "0"}
    )


def test_round_trip(scene, tmp_path):
    write_scene(scene, tmp_path / "scene.json")
    again = read_scene(tmp_path / "scene.json")
    write_scene(again, tmp_path / "again.json")
    assert (tmp_path / "scene.json").read_bytes() == (tmp_path / "again.json").read_bytes()
    table = again.entity("table_2")
    assert table.type == "rigid" and table.parent == "floor_1" and table.mesh == "map/table_2.ply"
    assert table.cad is not None and table.cad.id == "table/test"
    np.testing.assert_allclose(table.cad.scale, 1.1, atol=FLOAT32_RESOLUTION)
    assert table.candidates[0].reason == "collides with chair_1 by 0.02 m"
    assert again.entity("floor_1").parent == "room"
    assert again.proximal[0][:2] == ("floor_1", "table_2")


@pytest.mark.parametrize(
    ("path", "value", "where"),
    [
        (("entities", 1, "type"), "blob", "entities/1/type"),
        (("entities", 1, "box", "size"), [1, 2], "entities/1/box/size"),
        (("schema_version",), "0.1", "schema_version"),
        (("entities", 0, "name"), "Table 2", "entities/0/name"),
    ],
)
def test_a_broken_file_is_refused_at_the_place_that_breaks(scene, tmp_path, path, value, where):
    file = tmp_path / "scene.json"
    write_scene(scene, file)
    data = json.loads(file.read_text())
    target = data
    for step in path[:-1]:
        target = target[step]
    target[path[-1]] = value
    file.write_text(json.dumps(data))
    with pytest.raises(SceneError, match=where):
        read_scene(file)


def test_a_missing_file_and_one_that_is_not_json(tmp_path):
    with pytest.raises(SceneError, match="isr run"):
        read_scene(tmp_path / "scene.json")
    (tmp_path / "scene.json").write_text("{")
    with pytest.raises(SceneError, match="not JSON"):
        read_scene(tmp_path / "scene.json")


def test_the_schema_lists_the_types_and_attachments_of_entities():
    entity = scene_schema()["$defs"]["entity"]["properties"]
    assert tuple(entity["type"]["enum"]) == get_args(EntityType)
    assert tuple(entity["attachment"]["enum"]) == get_args(Attachment)
