"""Border: pyarrow. Tidy tables on disk, as Parquet and as CSV."""

from __future__ import annotations

import csv
import dataclasses
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Generic, TypeVar

from isr_jax.errors import OutputError

from .rows import Row

RowT = TypeVar("RowT")


def refuse_without_pyarrow() -> None:
    """Raise `OutputError` before the first room, not after the last."""
    try:
        import pyarrow  # noqa: F401
    except ImportError:
        raise OutputError(
            "Parquet needs pyarrow, which is not installed", "pip install 'isr_jax[bench]'"
        ) from None


class TidyTable(Generic[RowT]):
    """Rows of one kind in a Parquet file and a CSV file of the same name.

    Args:
        row: A flat dataclass; its fields are the columns (``class_name`` is called ``class``):
            ``seed`` is an integer, ``value`` a number, all else text.
        stem: Name of the files.
        command: Writes the table; for messages.
    """

    def __init__(self, row: type[RowT], stem: str, command: str) -> None:
        self._row, self._command = row, command
        names = [field.name for field in dataclasses.fields(row)]  # type: ignore[arg-type]
        self.columns = tuple("class" if name == "class_name" else name for name in names)
        self.parquet, self.csv = f"{stem}.parquet", f"{stem}.csv"

    def write(self, rows: Sequence[RowT], out_dir: Path) -> None:
        """Write both files; each appears whole or not at all."""
        import pyarrow as pa
        import pyarrow.parquet as pq

        cells = [dataclasses.astuple(row) for row in rows]  # type: ignore[call-overload]
        columns = list(zip(*cells)) or [()] * len(self.columns)
        kinds = {"seed": pa.int64(), "value": pa.float64()}
        schema = pa.schema([(name, kinds.get(name, pa.string())) for name in self.columns])
        arrays = [pa.array(c, field.type) for c, field in zip(columns, schema, strict=True)]
        try:
            fresh = out_dir / f"{self.parquet}.new"
            pq.write_table(pa.Table.from_arrays(arrays, schema=schema), fresh, compression="zstd")
            os.replace(fresh, out_dir / self.parquet)
            _write_csv(self.columns, cells, out_dir / self.csv)
        except OSError as error:
            raise OutputError(f"{out_dir}: {error.strerror}", "give another --out") from None

    def read(self, out_dir: Path) -> list[RowT]:
        """The rows of the Parquet file."""
        import pyarrow.parquet as pq

        path = out_dir / self.parquet
        try:
            found: list[dict[str, Any]] = pq.read_table(path).to_pylist()
            return [
                self._row(**{_field(name): row[name] for name in self.columns}) for row in found
            ]
        except (OSError, KeyError, ValueError) as error:
            raise OutputError(
                f"{path} is no table of this benchmark: {error}", f"run `{self._command}` first"
            ) from None


def _write_csv(columns: tuple[str, ...], rows: list[tuple[Any, ...]], path: Path) -> None:
    fresh = path.with_suffix(".new")
    with fresh.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows(
            ["" if v is None else repr(v) if isinstance(v, float) else v for v in cells]
            for cells in rows
        )
    os.replace(fresh, path)


def _field(column: str) -> str:
    return "class_name" if column == "class" else column


BENCH = TidyTable(Row, "bench", "python -m experiments.bench --rooms 10 --out DIR")
"""The benchmark's own table."""
