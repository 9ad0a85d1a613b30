"""The folder that a run writes into: its settings, its log, and what made it."""

from __future__ import annotations

import logging
import platform
from importlib.metadata import version
from pathlib import Path

from ..config import Settings, settings_to_toml
from ..errors import IsrError, OutputError
from .reporter import LOGGER

_PACKAGES = ("jax", "jaxlib", "equinox", "optimistix", "numpy", "scipy", "trimesh", "mujoco")


def versions() -> dict[str, str]:
    """Versions of this package and of those whose numbers it depends on."""
    found = {name: version(name) for name in _PACKAGES}
    return {"isr_jax": version("isr_jax"), "python": platform.python_version(), **found}


class RunFolder:
    """The output folder of a run: made, tried for writing, its log open while the run lasts.

    Raises:
        OutputError: on entering, where the folder cannot be written.
    """

    def __init__(self, out_dir: Path, settings: Settings) -> None:
        self._dir, self._settings = out_dir, settings

    def __enter__(self) -> None:
        """Make the folder; raises `OutputError` where it cannot be written."""
        try:
            self._dir.mkdir(parents=True, exist_ok=True)
            (self._dir / "config.toml").write_text(settings_to_toml(self._settings), "utf-8")
            self._handler = logging.FileHandler(self._dir / "run.log", encoding="utf-8")
        except OSError as error:
            raise OutputError(
                f"cannot write to {self._dir}: {error.strerror}", "give another --out"
            ) from None
        self._handler.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s"))
        LOGGER.addHandler(self._handler)
        LOGGER.setLevel(min(LOGGER.level or logging.INFO, logging.INFO))

    def __exit__(self, kind: type | None, error: BaseException | None, _: object) -> None:
        if error is not None:
            foreseen = isinstance(error, IsrError | KeyboardInterrupt)
            said = str(error) or type(error).__name__
            LOGGER.error("stopped: %s", said, exc_info=None if foreseen else error)
        LOGGER.removeHandler(self._handler)
        self._handler.close()
