"""The page in the browser: it is served to this machine alone, holds the scene, and ends."""

from __future__ import annotations

import importlib
import socket
import time
import urllib.error
import urllib.request

import numpy as np
import pytest

from isr_jax.errors import OutputError, SceneError
from isr_jax.viewer import build_view, server
from isr_jax.viewer.layers import LAYERS

from .films import film, finished  # noqa: F401 (fixtures)


@pytest.fixture
def page(finished):  # noqa: F811
    """A server on the finished run, at a port that was free a moment ago."""
    running = build_view(finished.out_dir, port=free_port())
    yield running
    running.stop()


def free_port() -> int:
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


def answer(port: int) -> int:
    with urllib.request.urlopen(f"http://127.0.0.1:{port}/", timeout=10) as response:
        return response.status


def switches(page) -> dict:
    handles = page.gui._gui_input_handle_from_uuid.values()
    return {handle.label: handle for handle in handles if handle.label in LAYERS}


def test_the_page_is_served_and_ends(page):
    port = page.get_port()
    assert page.get_host() == "127.0.0.1"
    assert answer(port) == 200
    page.stop()
    for _ in range(50):
        try:
            answer(port)
        except (urllib.error.URLError, ConnectionError):
            return
        time.sleep(0.1)
    pytest.fail("the page is still served")


def nodes(page) -> dict:
    return page.scene._handle_from_node_name


def test_every_layer_is_sent_when_it_is_first_switched_on(page, finished):  # noqa: F811
    entity = finished.scene_file.entities[0].name
    marks = {"boxes": f"/boxes/{entity}", "contact graph": "/graph/supports"}
    marks |= {"map": "/map", "map, by instance": "/instances"}
    shown = switches(page)
    assert list(shown) == list(LAYERS)
    assert "/models" in nodes(page)
    for name, node in marks.items():
        assert node not in nodes(page)
        shown[name].value = True
        assert eventually(lambda node=node: node in nodes(page) and nodes(page)[node].visible)
        shown[name].value = False
        assert eventually(lambda node=node: not nodes(page)[node].visible)


def eventually(holds) -> bool:
    """The server answers switches in a thread of its own."""
    for _ in range(100):
        if holds():
            return True
        time.sleep(0.05)
    return False


def test_every_thing_is_named(page, finished):  # noqa: F811
    things = {e.name for e in finished.scene_file.entities if e.type != "layout"}
    named = {n.removeprefix("/names/") for n in nodes(page) if n.startswith("/names/")}
    assert named == things


def test_the_camera_starts_outside_the_furniture_and_looks_into_the_room(page, finished):  # noqa: F811
    camera = page.initial_camera
    boxes = [e.box for e in finished.scene_file.entities]
    assert camera.position[2] > max(float(b.center[2]) for b in boxes)
    floor = next(b for b, e in zip(boxes, finished.scene_file.entities) if e.class_name == "floor")
    aim = np.asarray(camera.look_at)[:2] - np.asarray(floor.center)[:2]
    assert np.linalg.norm(aim) < float(np.max(np.asarray(floor.size)[:2])) / 2


def test_a_taken_port_is_passed_over(page, finished):  # noqa: F811
    second = build_view(finished.out_dir, port=page.get_port())
    try:
        assert second.get_port() != page.get_port() and answer(second.get_port()) == 200
    finally:
        second.stop()


def test_without_viser_it_says_how_to_install_it(finished, monkeypatch):  # noqa: F811
    def absent(name):
        raise ImportError(name)

    monkeypatch.setattr(importlib, "import_module", absent)
    with pytest.raises(OutputError, match=r"isr_jax\[viewer\]"):
        server.view(finished.out_dir)


def test_a_folder_without_a_result_is_named(tmp_path):
    with pytest.raises(SceneError, match=str(tmp_path)):
        build_view(tmp_path)
