"""Compare the presets on furnished rooms: what each departure from the paper is worth.

python -m experiments.presets --out out/presets --seeds 8 21
"""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import tyro
from rich.console import Console
from rich.table import Table

import isr_jax as isr
from isr_jax.compile_cache import enable_compilation_cache
from isr_jax.config import PRESETS

FIGURES = (
    ("PQ", lambda run, score: score.panoptic.pq),
    ("PQ things", lambda run, score: score.panoptic.pq_things),
    ("box mAP@0.5", lambda run, score: score.unrefined_boxes.map50),
    ("box mAP_re@0.5", lambda run, score: score.boxes.map50),
    ("support precision", lambda run, score: score.supports.precision),
    ("support recall", lambda run, score: score.supports.recall),
    ("CAD aligned", lambda run, score: score.cad.accuracy),
    ("CAD placed", lambda run, score: score.cad.placed),
    ("same model", lambda run, score: score.cad.same_model),
    ("max drift, m", lambda run, score: _max_drift(run)),
    ("penetration, m", lambda run, score: run.stability.exported.penetration_max_m),
    ("seconds", lambda run, score: run.seconds),
)


def main(
    out: Path = Path("out/presets"),
    seeds: tuple[int, ...] = (8, 21),
    presets: tuple[str, ...] = tuple(PRESETS),
    segmenter: str = "simulated:medium",
    frames: int = 150,
) -> None:
    """Reconstruct each room with each preset and score it against the truth.

    Args:
        out: Receives a folder a room and preset, and ``presets.csv``.
        seeds: Rooms.
        presets: Of `isr_jax.config.PRESETS`.
        segmenter: How wrong the masks are.
        frames: Length of each walk.
    """
    library = isr.default_library()
    rows = []
    for seed in seeds:
        film = isr.film_room(out / f"room_{seed}" / "sequence", seed=seed, frames=frames)
        for name in presets:
            folder = out / f"room_{seed}" / name.replace("+", "p")
            run = isr.run(film, folder, segmenter=segmenter, settings=isr.preset(name))
            score = isr.evaluate(
                folder,
                film / "truth",
                symmetry={m.id: m.symmetry for m in library.models},
                model_size={m.id: m.size for m in library.models},
                unrefined={e.name: e.box for e in run.scene.entities},
            )
            rows.append((seed, name, *(figure(run, score) for _, figure in FIGURES)))
    _write(out / "presets.csv", rows)
    Console().print(_table(rows, presets, segmenter))


def _max_drift(run) -> float:
    return max((b.drift_end_m for b in run.stability.exported.bodies), default=0.0)


def _write(path: Path, rows: list[tuple]) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(("seed", "preset", *(name for name, _ in FIGURES)))
        writer.writerows(rows)


def _table(rows: list[tuple], presets: tuple[str, ...], segmenter: str) -> Table:
    rooms = len({row[0] for row in rows})
    table = Table("mean", *presets, title=f"{rooms} rooms, masks {segmenter}")
    for k, (name, _) in enumerate(FIGURES):
        values = [
            np.mean([row[2 + k] for row in rows if row[1] == p and row[2 + k] is not None] or [0])
            for p in presets
        ]
        table.add_row(name, *(f"{v:.4f}" if name.endswith(" m") else f"{v:.3g}" for v in values))
    return table


if __name__ == "__main__":
    enable_compilation_cache()
    tyro.cli(main)
