"""A process of its own for hulls: reads tasks from its input, writes results to its output.

Decomposition runs in C++ on meshes from anywhere; where it crashes or hangs, this process goes
and the program stays. Unlike `multiprocessing` it does not import the caller's main module.
"""

from __future__ import annotations

import dataclasses
import os
import struct
import subprocess
import sys
import threading
from typing import IO

_LENGTH = struct.Struct("<Q")


def write_message(stream: IO[bytes], data: bytes) -> None:
    """Length, then content."""
    stream.write(_LENGTH.pack(len(data)) + data)
    stream.flush()


def read_message(stream: IO[bytes]) -> bytes | None:
    """The next content; None where the stream has ended."""
    head = stream.read(_LENGTH.size)
    if len(head) < _LENGTH.size:
        return None
    (length,) = _LENGTH.unpack(head)
    data = stream.read(length)
    return data if len(data) == length else None


@dataclasses.dataclass(eq=False)
class Worker:
    """One such process; it is started anew after a crash."""

    timeout_s: float
    command: tuple[str, ...] = (sys.executable, "-m", __name__)
    _process: subprocess.Popen | None = None

    def ask(self, task: bytes) -> bytes | None:
        """The result of a task; None where the process crashed or took too long."""
        process = self._process or self._started()
        stop = threading.Timer(self.timeout_s, process.kill)
        stop.start()
        try:
            assert process.stdin is not None and process.stdout is not None
            write_message(process.stdin, task)
            answer = read_message(process.stdout)
        except OSError:
            answer = None
        finally:
            stop.cancel()
        if answer is None:
            self.close()
        return answer

    def close(self) -> None:
        """End the process."""
        if self._process is not None:
            self._process.kill()
            self._process.communicate()
            self._process = None

    def _started(self) -> subprocess.Popen:
        paths = os.pathsep.join(path for path in sys.path if path)
        self._process = subprocess.Popen(
            self.command,
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            env={**os.environ, "PYTHONPATH": paths, "JAX_PLATFORMS": "cpu"},
        )
        return self._process


def _serve() -> None:
    from .link_hulls import METHODS
    from .model_hulls import model_hulls
    from .packing import packed_hulls, unpacked_shapes

    # Libraries that print must not write into the answers.
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "wb")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    while (task := read_message(sys.stdin.buffer)) is not None:
        shapes, method = unpacked_shapes(task)
        write_message(answers, packed_hulls(model_hulls(shapes, METHODS[method])))


if __name__ == "__main__":
    _serve()
