"""What a benchmark measures: figures with a unit, a direction and, where one is stated, a bound."""

from __future__ import annotations

import dataclasses
import statistics
import time
from collections.abc import Callable, Sequence
from typing import Literal, TypeVar

import jax
import numpy as np
from rich.console import Console
from rich.table import Table

T = TypeVar("T")


@dataclasses.dataclass(frozen=True)
class Figure:
    """One measured number."""

    name: str
    value: float
    unit: str
    better: Literal["higher", "lower"]
    bound: float | None = None
    """What the project promises; printed, never enforced: clocks differ."""

    @property
    def kept(self) -> bool | None:
        """Whether the bound is kept; None without one."""
        if self.bound is None:
            return None
        higher = self.better == "higher"
        return self.value >= self.bound if higher else self.value <= self.bound


@dataclasses.dataclass(frozen=True, eq=False)
class Stopwatch:
    """Wall and core time of things that are done again and again, side by side."""

    wall_s: dict[str, list[float]] = dataclasses.field(default_factory=dict)
    core_s: dict[str, list[float]] = dataclasses.field(default_factory=dict)
    """Of all threads of the process."""

    def time(self, name: str, work: Callable[..., T], *args: object, items: int = 1) -> T:
        """What ``work`` returns, once it is computed; its time counts for each of its ``items``."""
        wall, core = time.perf_counter(), time.process_time()
        result = jax.block_until_ready(work(*args))
        self.wall_s.setdefault(name, []).append((time.perf_counter() - wall) / items)
        self.core_s.setdefault(name, []).append((time.process_time() - core) / items)
        return result

    def ms(self, name: str, *, core: bool = False) -> float:
        """Median milliseconds of an item."""
        return 1000 * statistics.median((self.core_s if core else self.wall_s)[name])

    def extra_ms(self, name: str, below: str, *, core: bool = False) -> float:
        """Median of what ``name`` takes longer than ``below`` did next to it, milliseconds."""
        seconds = self.core_s if core else self.wall_s
        return 1000 * float(np.median(np.subtract(seconds[name], seconds[below])))


def seconds_each(work: Callable[[], object], repeats: int) -> tuple[float, float]:
    """Median wall time and median core time (of all threads) of a call, seconds.

    After one call that compiles what there is to. Core time hardly feels what else runs.
    """
    work()
    walls, cores = [], []
    for _ in range(repeats):
        wall, core = time.perf_counter(), time.process_time()
        work()
        walls.append(time.perf_counter() - wall)
        cores.append(time.process_time() - core)
    return statistics.median(walls), statistics.median(cores)


def note(text: str) -> None:
    """Print a line beside the tables."""
    Console().print(text, markup=False)


def show(title: str, figures: Sequence[Figure]) -> None:
    """Print a table: figure, value, unit, which way is better, bound."""
    table = Table(title=title)
    for column in ("figure", "value", "unit", "better", "bound"):
        table.add_column(column, justify="right" if column in ("value", "bound") else "left")
    for figure in figures:
        bound = "" if figure.bound is None else f"{figure.bound:g}"
        kept = {None: "", True: " kept", False: " missed"}[figure.kept]
        table.add_row(figure.name, f"{figure.value:.3g}", figure.unit, figure.better, bound + kept)
    Console().print(table)
