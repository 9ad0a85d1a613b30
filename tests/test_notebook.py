"""The notebook that is shipped runs from top to bottom, and is shipped without its outputs."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import nbformat
import pytest
from nbclient import NotebookClient

from isr_jax.runtime.caches import user_cache_dir

from .conftest import REPOSITORY

NOTEBOOK = REPOSITORY / "notebooks" / "quickstart.ipynb"


def read() -> nbformat.NotebookNode:
    return nbformat.read(NOTEBOOK, as_version=4)


def test_it_is_shipped_without_outputs():
    cells = [cell for cell in read().cells if cell.cell_type == "code"]
    assert cells
    assert all(not cell.outputs and cell.execution_count is None for cell in cells)


def text_of(cell) -> str:
    return "".join(output.get("text", "") for output in cell.outputs)


@pytest.fixture
def kernel(tmp_path, monkeypatch) -> Path:
    """A kernel of this interpreter with this package, in an empty folder, compiling little."""
    monkeypatch.setenv("PYTHONPATH", str(REPOSITORY))
    monkeypatch.setenv("JAX_COMPILATION_CACHE_DIR", str(user_cache_dir() / "xla"))
    monkeypatch.setenv("JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS", "0.2")
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    spec = tmp_path / "share" / "kernels" / "python3"
    spec.mkdir(parents=True)
    arguments = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    content = {"argv": arguments, "display_name": "Python 3", "language": "python"}
    (spec / "kernel.json").write_text(json.dumps(content))
    monkeypatch.setenv("JUPYTER_PATH", str(tmp_path / "share"))
    folder = tmp_path / "empty"
    folder.mkdir()
    return folder


def test_it_runs_from_top_to_bottom(kernel):
    notebook = read()
    client = NotebookClient(notebook, timeout=300, resources={"metadata": {"path": str(kernel)}})
    client.execute()
    written = "\n".join(text_of(cell) for cell in notebook.cells if cell.cell_type == "code")
    pictures = sum(
        "image/png" in output.get("data", {})
        for cell in notebook.cells
        if cell.cell_type == "code"
        for output in cell.outputs
    )
    assert "penetration" in written and "PQ" in written
    assert pictures == 2
    assert (kernel / "out" / "quickstart" / "scene.xml").is_file()
    slope = float(written.split("d cost / d height = ")[1].split()[0])
    assert slope > 0.0, "a heavier height costs more where it cannot be met"
