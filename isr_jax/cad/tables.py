"""A library and its models as tables for a terminal."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

import numpy as np
from rich.console import Group, RenderableType
from rich.markup import escape
from rich.table import Table

from ..library import CadLibrary, CadModel, Handle
from ..robot_model import Joint


def library_table(library: CadLibrary, models: Sequence[CadModel] | None = None) -> Table:
    """One row per model; what all have in common stands below.

    Args:
        library: Named in the title.
        models: The ones to list; all by default.
    """
    shown = library.models if models is None else models
    title = f"{len(shown)} models in {escape(library.source)}"
    table = Table(title=title, title_justify="left", caption_justify="left")
    table.add_column("model", no_wrap=True)
    for heading in ("size, cm", "joints", "mass, kg"):
        table.add_column(heading, justify="right", no_wrap=True)
    for heading in ("mount", "planes"):
        table.add_column(heading, no_wrap=True)
    origins = ("licence", "creator", "source")
    differing = [name for name in origins if len({getattr(m, name) for m in shown}) > 1]
    for name in differing:
        table.add_column(name, overflow="fold")
    common = [f"{n}: {getattr(shown[0], n)}" for n in origins if shown and n not in differing]
    table.caption = escape(", ".join(common)) or None
    for model in shown:
        table.add_row(
            model.id,
            _lengths(model),
            str(len(model.moving_joints) or ""),
            f"{model.robot.mass_kg:.2f}",
            model.mount,
            _planes(model),
            *(escape(getattr(model, name)) for name in differing),
        )
    return table


def class_table(library: CadLibrary) -> Table:
    """One row per class: how many models, how many of them have joints."""
    table = Table(title=f"{len(library)} models in {escape(library.source)}", title_justify="left")
    for heading in ("class", "models", "with joints"):
        table.add_column(heading)
    count = Counter(model.class_name for model in library.models)
    moving = Counter(model.class_name for model in library.models if model.articulated)
    for name in sorted(count):
        table.add_row(name, str(count[name]), str(moving[name] or ""))
    return table


def model_tables(model: CadModel) -> RenderableType:
    """All that is known of one model."""
    parts = [_facts(model), _links(model)]
    if model.robot.moving_joints:
        parts.append(_joints(model))
    return Group(*parts, _plane_table(model))


def _facts(model: CadModel) -> Table:
    table = Table(title=model.id, title_justify="left", show_header=False)
    table.add_column("what")
    table.add_column("value", overflow="fold")
    turns = {0: "round", 1: "none", 2: "half a turn", 4: "quarter turns"}
    swelling = f", swelling {1000 * model.swelling_m:.1f} mm" if model.swelling_m else ""
    rows = [
        ("class", model.class_name),
        ("width x depth x height", f"{_lengths(model)} cm"),
        ("mass", f"{model.robot.mass_kg:.3g} kg"),
        ("mount", model.mount),
        ("symmetry", turns[model.symmetry]),
        ("collision hulls", model.collision + swelling),
        ("licence", model.licence),
        ("creator", model.creator),
        ("source", model.source),
        ("content", model.content_hash[:16]),
        *(("note", note) for note in model.notes),
    ]
    for name, value in rows:
        table.add_row(name, escape(value))
    return table


def _links(model: CadModel) -> Table:
    table = Table(title="parts", title_justify="left")
    for heading in ("link", "mass", "hulls", "triangles", "friction", "materials"):
        table.add_column(heading)
    for link in model.robot.links:
        names = [f"{v.name} (texture)" if v.texture else v.name for v in link.visuals]
        table.add_row(
            link.name,
            f"{link.mass_kg:.3g} kg",
            str(len(link.hulls)),
            str(sum(len(v.mesh.faces) for v in link.visuals)),
            f"{link.friction:.2g}",
            escape(", ".join(dict.fromkeys(names))),
        )
    return table


def _joints(model: CadModel) -> Table:
    table = Table(title="joints", title_justify="left")
    for heading in ("joint", "moves", "range"):
        table.add_column(heading, no_wrap=True)
    for heading in ("damping", "friction", "handle"):
        table.add_column(heading)
    handles = {handle.joint: handle for handle in model.handles}
    for joint in model.robot.moving_joints:
        table.add_row(
            joint.name,
            f"{joint.child} on {joint.parent}",
            joint_range(joint),
            f"{joint.damping:.3g}",
            f"{joint.friction:.3g}",
            _handle(handles.get(joint.name)),
        )
    return table


def _handle(handle: Handle | None) -> str:
    if handle is None:
        return "none"
    at = ", ".join(f"{1000 * float(v):.0f}" for v in handle.position)
    return f"{handle.link} at {at} mm{' (estimated)' if handle.estimated else ''}"


def joint_range(joint: Joint) -> str:
    """Limits in degrees or millimetres."""
    if joint.kind == "continuous":
        return "without end"
    if joint.kind == "prismatic":
        return f"{1000 * joint.lower:.0f}..{1000 * joint.upper:.0f} mm"
    return f"{np.degrees(joint.lower):.0f}..{np.degrees(joint.upper):.0f} degrees"


def _plane_table(model: CadModel) -> Table:
    table = Table(title="planes", title_justify="left")
    for heading in ("plane", "link", "faces", "size", "area", "height", "carries"):
        table.add_column(heading)
    planes = model.planes
    for k, link in enumerate(model.plane_link):
        corners = np.asarray(planes.corners[k])
        sides = np.linalg.norm(corners[[1, 3]] - corners[0], axis=1)
        table.add_row(
            str(k),
            link,
            _facing(np.asarray(planes.normal[k])),
            f"{100 * sides[0]:.0f} x {100 * sides[1]:.0f} cm",
            f"{float(planes.area_m2[k]):.3f} m^2",
            f"{100 * (corners[:, 2].mean() + model.size[2] / 2):.1f} cm",
            "yes" if model.plane_supporting[k] else "",
        )
    return table


def _facing(normal: np.ndarray) -> str:
    names = {(0, 1): "right", (0, -1): "left", (1, 1): "back", (1, -1): "front", (2, 1): "up"}
    axis = int(np.argmax(np.abs(normal)))
    if abs(normal[axis]) < 0.99:
        return ", ".join(f"{v:.2f}" for v in normal)
    return names.get((axis, int(np.sign(normal[axis]))), "down")


def _lengths(model: CadModel) -> str:
    return " x ".join(f"{100 * float(v):.3g}" for v in model.size)


def _planes(model: CadModel) -> str:
    carrying = int(model.plane_supporting.sum())
    count = len(model.plane_link)
    return f"{count}, {carrying} carry" if carrying else str(count)
