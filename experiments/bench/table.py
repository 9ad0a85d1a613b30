"""Border: pyarrow. The tidy table on disk, as Parquet and as CSV."""

from __future__ import annotations

import csv
import dataclasses
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from isr_jax.errors import OutputError

from .rows import Row

COLUMNS = tuple("class" if f.name == "class_name" else f.name for f in dataclasses.fields(Row))
PARQUET, CSV = "bench.parquet", "bench.csv"


def refuse_without_pyarrow() -> None:
    """Raise `OutputError` before the first room, not after the last."""
    try:
        import pyarrow  # noqa: F401
    except ImportError:
        raise OutputError(
            "Parquet needs pyarrow, which is not installed", "pip install 'isr_jax[bench]'"
        ) from None


def write_table(rows: Sequence[Row], out_dir: Path) -> None:
    """Write both files; each appears whole or not at all."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns = list(zip(*(dataclasses.astuple(row) for row in rows))) or [()] * len(COLUMNS)
    kinds = {"seed": pa.int64(), "value": pa.float64()}
    schema = pa.schema([(name, kinds.get(name, pa.string())) for name in COLUMNS])
    arrays = [pa.array(column, field.type) for column, field in zip(columns, schema, strict=True)]
    try:
        fresh = out_dir / f"{PARQUET}.new"
        pq.write_table(pa.Table.from_arrays(arrays, schema=schema), fresh, compression="zstd")
        os.replace(fresh, out_dir / PARQUET)
        _write_csv(rows, out_dir / CSV)
    except OSError as error:
        raise OutputError(f"{out_dir}: {error.strerror}", "give another --out") from None


def _write_csv(rows: Sequence[Row], path: Path) -> None:
    fresh = path.with_suffix(".new")
    with fresh.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(COLUMNS)
        writer.writerows(
            ["" if v is None else repr(v) if isinstance(v, float) else v for v in cells]
            for cells in (dataclasses.astuple(row) for row in rows)
        )
    os.replace(fresh, path)


def read_table(out_dir: Path) -> list[Row]:
    """The rows of ``bench.parquet``."""
    import pyarrow.parquet as pq

    path = out_dir / PARQUET
    try:
        found: list[dict[str, Any]] = pq.read_table(path).to_pylist()
        return [Row(**{_field(name): row[name] for name in COLUMNS}) for row in found]
    except (OSError, KeyError, ValueError) as error:
        raise OutputError(
            f"{path} is no table of this benchmark: {error}",
            "run `python -m experiments.bench --rooms 10 --out DIR` first",
        ) from None


def _field(column: str) -> str:
    return "class_name" if column == "class" else column
