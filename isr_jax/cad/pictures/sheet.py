"""Border: contact sheets: every model in a tile of its own, its name and size below (PIL)."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from jaxtyping import UInt8
from PIL import Image, ImageDraw, ImageFont

from ...errors import OutputError, SettingError
from ...library import CadModel
from ..poses import opened
from .picture import PAPER, picture

Progress = Callable[[int, int], None]
TILE_WIDTH, TILE_HEIGHT = 200, 172
"""Pixels of a model's picture."""
_TEXT_HEIGHT = 34
_MARGIN = 8
_FONT_SIZE = 12
_INK, _GREY = (30, 30, 34), (110, 110, 116)
_COLORS = 255
"""Of the written PNG: a palette makes a sheet a third as large."""


def draw_models(
    models: Sequence[CadModel],
    path_png: Path | str,
    *,
    columns: int = 8,
    open_share: float = 0.0,
    progress: Progress | None = None,
) -> None:
    """Write a contact sheet.

    Args:
        models: In this order, row by row.
        path_png: Written.
        columns: Models per row.
        open_share: How far joints are open, of their range.
        progress: Told (done, total).

    Raises:
        SettingError: No models, or less than one column.
        OutputError: The picture cannot be written.
    """
    if not models or columns < 1:
        problem = f"a sheet of {len(models)} models in {columns} columns"
        raise SettingError(problem, "give at least one model and one column")
    columns = min(columns, len(models))
    tiles = []
    for done, model in enumerate(models):
        positions = opened(model.robot, open_share)
        image = picture(model, TILE_WIDTH, TILE_HEIGHT, positions)
        tiles.append(labelled(image, model.id, caption(model)))
        if progress is not None:
            progress(done + 1, len(models))
    _write(grid(tiles, columns), Path(path_png))


def draw_model(
    model: CadModel, path_png: Path | str, *, width: int = 480, height: int = 420
) -> None:
    """Write one model, closed; beside it, where it has joints, with all of them open.

    Raises:
        OutputError: The picture cannot be written.
    """
    wide = opened(model.robot, 0.8)
    states = [{}, wide] if wide else [{}]
    tiles = [picture(model, width, height, state, room_for=wide) for state in states]
    texts = ("", "joints open") if wide else ("",)
    shown = [
        labelled(tile, model.id, f"{caption(model)}  {text}".rstrip())
        for tile, text in zip(tiles, texts, strict=True)
    ]
    _write(grid(shown, len(shown)), Path(path_png))


def caption(model: CadModel) -> str:
    """Size, and how many joints move."""
    size = " x ".join(f"{100 * float(v):.3g}" for v in model.size)
    count = len(model.moving_joints)
    joints = f", {count} joint{'s' if count > 1 else ''}" if count else ""
    return f"{size} cm{joints}"


def labelled(
    image: UInt8[np.ndarray, "height width 3"], title: str, text: str
) -> UInt8[np.ndarray, "taller width 3"]:
    """The image with two lines of text below."""
    height, width = image.shape[:2]
    canvas = Image.new("RGB", (width, height + _TEXT_HEIGHT), _paper())
    canvas.paste(Image.fromarray(image), (0, 0))
    draw, font = ImageDraw.Draw(canvas), ImageFont.load_default(_FONT_SIZE)
    for line, (words, color) in enumerate(((title, _INK), (text, _GREY))):
        middle = (width / 2, height + 9 + 16 * line)
        draw.text(middle, _fitted(words, font, width), color, font, anchor="mm")
    return np.asarray(canvas)


def _fitted(words: str, font, width: int) -> str:
    """The words, cut where they are wider than a tile."""
    if font.getlength(words) <= width:
        return words
    while words and font.getlength(f"{words}...") > width:
        words = words[:-1]
    return f"{words}..."


def grid(tiles: Sequence[np.ndarray], columns: int) -> UInt8[np.ndarray, "height width 3"]:
    """Tiles of one size in rows."""
    height, width = (n + _MARGIN for n in tiles[0].shape[:2])
    rows = -(-len(tiles) // columns)
    whole = np.tile(np.array(_paper(), np.uint8), (rows * height, columns * width, 1))
    for i, tile in enumerate(tiles):
        y, x = (i // columns) * height + _MARGIN // 2, (i % columns) * width + _MARGIN // 2
        whole[y : y + tile.shape[0], x : x + tile.shape[1]] = tile
    return whole


def _write(image: np.ndarray, path: Path) -> None:
    small = Image.fromarray(image).quantize(_COLORS, dither=Image.Dither.NONE)
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        small.save(path, "PNG", optimize=True)
    except (OSError, ValueError) as error:
        problem = f"cannot write {path}: {error}"
        raise OutputError(problem, "give a writable path that ends in .png") from None


def _paper() -> tuple[int, int, int]:
    return tuple(round(float(v)) for v in PAPER)  # type: ignore[return-value]
