"""Border: the JSON side of the COCO panoptic format, read and checked."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path
from typing import Any

from ..classes import class_named, label_table
from ..classes.label_lists import label_list
from ..errors import ClassError, SegmenterError


@dataclasses.dataclass(frozen=True)
class Annotation:
    """The segments of one image; crowds are class 0."""

    file_name: str
    """Of the PNG."""
    ids: tuple[int, ...]
    class_ids: tuple[int, ...]
    """Our class; 0 = none of ours."""
    scores: tuple[float, ...]
    is_group: tuple[bool, ...]
    """Of a category whose instances are not told apart (``isthing`` 0)."""


@dataclasses.dataclass(frozen=True)
class PanopticIndex:
    """What a COCO panoptic JSON file says."""

    annotations: dict[str, Annotation]
    """By the name of the frame."""


@dataclasses.dataclass(frozen=True)
class _Category:
    class_id: int
    is_thing: bool


def find_json(path: Path) -> Path:
    """The JSON file that ``path`` is or holds: ``panoptic.json``, or the one ``panoptic*.json``.

    Raises:
        SegmenterError: The folder holds several.
    """
    if path.suffix == ".json" or (path / "panoptic.json").is_file():
        return path if path.suffix == ".json" else path / "panoptic.json"
    found = sorted(path.glob("panoptic*.json"))
    if len(found) > 1:
        raise SegmenterError(
            f"{path} has {len(found)} files of masks: {', '.join(f.name for f in found)}",
            f"name one: masks:{found[0]}",
        )
    return found[0] if found else path / "panoptic.json"


def read_index(path: Path) -> PanopticIndex:
    """Read and check a COCO panoptic JSON file before any frame is asked for.

    Raises:
        SegmenterError: It is missing, is no JSON, or does not follow the format.
    """
    content = _read_json(path)
    _check_members(content, path)
    categories = _categories(content["categories"], path)
    images = {i["id"]: Path(i["file_name"]).stem for i in content.get("images", ())}
    annotations: dict[str, Annotation] = {}
    for annotation in content["annotations"]:
        name = images.get(annotation.get("image_id"), Path(annotation["file_name"]).stem)
        if name in annotations:
            raise SegmenterError(
                f"{path} has two annotations for image {name!r}", "leave one of them"
            )
        annotations[name] = _annotation(annotation, categories, path)
    return PanopticIndex(annotations)


def _annotation(
    content: dict[str, Any], categories: dict[int, _Category], path: Path
) -> Annotation:
    segments = content["segments_info"]
    unknown = [s for s in segments if s["category_id"] not in categories]
    if unknown:
        raise SegmenterError(
            f"{path}: segment {unknown[0]['id']} has category {unknown[0]['category_id']}, "
            "which `categories` does not list",
            "add the category to the file",
        )
    of = [categories[s["category_id"]] for s in segments]
    crowd = [bool(s.get("iscrowd", 0)) for s in segments]
    return Annotation(
        content["file_name"],
        tuple(int(s["id"]) for s in segments),
        tuple(0 if c else o.class_id for o, c in zip(of, crowd, strict=True)),
        tuple(float(s.get("score", 1.0)) for s in segments),
        tuple(not o.is_thing for o in of),
    )


def _read_json(path: Path) -> dict[str, Any]:
    try:
        content = json.loads(path.read_text("utf-8"))
    except FileNotFoundError:
        raise SegmenterError(
            f"no masks: {path} does not exist",
            "give a folder with panoptic.json and panoptic/*.png, or another --segmenter",
        ) from None
    except (json.JSONDecodeError, UnicodeDecodeError) as error:
        raise SegmenterError(f"{path} is not JSON: {error}", "write it again") from None
    _check_keys(content, ("annotations", "categories"), str(path))
    return content


def _check_members(content: dict[str, Any], path: Path) -> None:
    """What every category, image, annotation and segment must have."""
    for i, category in enumerate(content["categories"]):
        _check_keys(category, ("id", "name"), f"{path}: categories[{i}]")
    for i, image in enumerate(content.get("images", ())):
        _check_keys(image, ("id", "file_name"), f"{path}: images[{i}]")
    for i, annotation in enumerate(content["annotations"]):
        where = f"{path}: annotations[{i}]"
        _check_keys(annotation, ("file_name", "segments_info"), where)
        for j, segment in enumerate(annotation["segments_info"]):
            _check_keys(segment, ("id", "category_id"), f"{where}.segments_info[{j}]")


def _check_keys(member: Any, keys: tuple[str, ...], where: str) -> None:
    missing = [k for k in keys if not isinstance(member, dict) or k not in member]
    if missing:
        raise SegmenterError(
            f"{where} has no {' and no '.join(missing)}", "follow the COCO panoptic format"
        )


def _categories(categories: list[dict[str, Any]], path: Path) -> dict[int, _Category]:
    """COCO's own where id and name are COCO's, else the class of ours that has the name."""
    official = {(label.id, label.name) for label in label_list("coco_panoptic")}
    table, found = label_table("coco_panoptic"), {}
    for category in categories:
        key = (category["id"], category["name"])
        try:
            class_id = int(table[key[0]]) if key in official else class_named(key[1]).id
        except ClassError as error:
            raise SegmenterError(f"{path}: {error.problem}", error.hint) from None
        found[key[0]] = _Category(class_id, bool(category.get("isthing", 1)))
    return found
