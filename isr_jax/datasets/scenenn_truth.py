"""Ground truth of a SceneNN scene: ``NNN.ply`` with one label per vertex, ``NNN.xml`` with names.

An element ``label`` has id, text, color and obbox: centre, size and quaternion x y z w (the
authors' project page, quoted in SceneNN issue 11). The later annotation (contrib/nyu_class) adds
nyu_class, a NYU40 name, and an axis-aligned box, which is not read: it follows from the vertices.
Annotations of the two versions score differently, so `AnnotatedMesh.annotation` names which it was.
"""

from __future__ import annotations

import xml.etree.ElementTree as ET
from pathlib import Path

import defusedxml
import defusedxml.ElementTree
import numpy as np

from ..errors import SequenceError
from .annotated_mesh import (
    AnnotatedBox,
    AnnotatedInstance,
    AnnotatedMesh,
    annotation_notes,
    read_mesh,
)
from .annotation_names import class_of_name

VERSIONS = ("SceneNN (text)", "SceneNN (nyu_class)")
_LABEL_COLUMN = "label"
_MAX_XML_BYTES = 1 << 26
_NOTHING = {"", "unknown", "none", "unlabeled", "unlabelled"}
"""Names of labels that name nothing."""


def read_scenenn_truth(folder: str | Path, *, version: str | None = None) -> AnnotatedMesh:
    """Read the mesh and annotation of a scene.

    Args:
        folder: Holds ``<name>.ply`` and ``<name>.xml``, as published.
        version: One of `VERSIONS`: which names to take where the file has both; by default the
            later, ``nyu_class``, where every label has it.

    Raises:
        SequenceError: a file is missing or damaged, or the mesh has no labels.
    """
    folder = Path(folder)
    ply, xml = _files(folder)
    mesh, columns = read_mesh(ply)
    if _LABEL_COLUMN not in columns or columns[_LABEL_COLUMN].dtype.kind not in "iu":
        raise SequenceError(
            f"{ply} has no whole-number column {_LABEL_COLUMN!r} a vertex, but "
            f"{', '.join(columns) or 'none'}",
            "take the annotated mesh of the main repository",
        )
    instance = columns[_LABEL_COLUMN].astype(np.int64)
    labels = _labels(xml)
    taken = _version(xml, labels, version)
    attribute = "nyu_class" if taken == VERSIONS[1] else "text"
    instances = tuple(_instance(xml, label, attribute) for label in labels)
    instances, instance, dropped = _named(instances, instance)
    notes = annotation_notes(instances, instance)
    return AnnotatedMesh(ply.stem, taken, mesh, instance, instances, (*dropped, *notes))


def _files(folder: Path) -> tuple[Path, Path]:
    meshes = sorted(p for p in folder.glob("*.ply") if p.with_suffix(".xml").is_file())
    if len(meshes) == 1:
        return meshes[0], meshes[0].with_suffix(".xml")
    found = ", ".join(p.name for p in meshes) or "none"
    raise SequenceError(
        f"{folder}: need one mesh with an annotation of the same name, found {found}",
        f"put {folder.name}.ply and {folder.name}.xml there, as SceneNN publishes them",
    )


def _labels(path: Path) -> list[ET.Element]:
    try:
        if path.stat().st_size > _MAX_XML_BYTES:
            raise SequenceError(
                f"{path} is {path.stat().st_size} bytes long (at most {_MAX_XML_BYTES})",
                "restore the file",
            )
        root = defusedxml.ElementTree.fromstring(path.read_bytes(), forbid_dtd=True)
    except OSError as error:
        raise SequenceError(f"{path}: {error.strerror}", "restore the file") from None
    except defusedxml.DefusedXmlException as error:
        raise SequenceError(
            f"{path} declares a document type or entities ({type(error).__name__})",
            "write it without <!DOCTYPE ...>",
        ) from None
    except (ET.ParseError, ValueError, LookupError) as error:
        raise SequenceError(f"{path} is no valid XML: {error}", "restore the file") from None
    labels = list(root.iter("label"))
    if not labels:
        raise SequenceError(f"{path} has no element `label`", "give SceneNN's annotation")
    return labels


def _version(path: Path, labels: list[ET.Element], wanted: str | None) -> str:
    later = all("nyu_class" in label.attrib for label in labels)
    if wanted is None:
        return VERSIONS[1] if later else VERSIONS[0]
    if wanted not in VERSIONS:
        raise SequenceError(
            f"unknown annotation version {wanted!r}", f"use one of: {', '.join(VERSIONS)}"
        )
    if wanted == VERSIONS[1] and not later:
        raise SequenceError(
            f"{path} has labels without nyu_class", "take the annotation of contrib/nyu_class"
        )
    return wanted


def _instance(path: Path, label: ET.Element, attribute: str) -> AnnotatedInstance:
    id = label.get("id", "")
    if not (id.isascii() and id.isdigit() and 0 < len(id) < 10):
        raise SequenceError(f"{path}: a label has the id {id!r}", "ids are whole numbers")
    name = label.get(attribute) or ""
    return AnnotatedInstance(int(id), name, class_of_name(name), _box(path, int(id), label))


def _box(path: Path, id: int, label: ET.Element) -> AnnotatedBox | None:
    text = label.get("obbox")
    if not text:
        return None
    try:
        values = np.array([float(v) for v in text.replace(",", " ").split()])
    except ValueError:
        values = np.zeros(0)
    length = float(np.linalg.norm(values[6:])) if len(values) == 10 else 0.0
    if not (np.isfinite(values).all() and abs(length - 1) < 0.01 and (values[3:6] >= 0).all()):
        raise SequenceError(
            f"{path}: label {id} has obbox = {text!r}",
            "it is 10 numbers: centre, size, and a unit quaternion x y z w",
        )
    return AnnotatedBox(values[:3], values[3:6], _rotation(values[6:] / length))


def _rotation(quaternion: np.ndarray) -> np.ndarray:
    """R = I + 2 w [v] + 2 [v]^2 for a unit quaternion (v, w)."""
    x, y, z, w = quaternion
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + 2 * w * cross + 2 * cross @ cross


def _named(
    instances: tuple[AnnotatedInstance, ...], instance: np.ndarray
) -> tuple[tuple[AnnotatedInstance, ...], np.ndarray, tuple[str, ...]]:
    """Without labels that name nothing; vertices whose label the XML does not list are nothing."""
    by_id = {i.id: i for i in instances}
    if len(by_id) != len(instances):
        twice = sorted({i.id for i in instances if sum(j.id == i.id for j in instances) > 1})
        raise SequenceError(f"labels {twice} are listed more than once", "restore the annotation")
    real = tuple(i for i in instances if i.id > 0 and i.label.strip().lower() not in _NOTHING)
    listed = np.isin(instance, list(by_id))
    strange = sorted(set(instance[~listed & (instance != 0)].tolist()))
    notes = ()
    if strange:
        shown = ", ".join(map(str, strange[:10])) + (" ..." if len(strange) > 10 else "")
        share = float(np.mean(~listed & (instance != 0)))
        notes = (f"{share:.1%} of the vertices have labels that the XML does not list: {shown}",)
    return real, np.where(np.isin(instance, [i.id for i in real]), instance, 0), notes
