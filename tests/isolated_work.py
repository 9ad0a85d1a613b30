"""Work for other processes: some of it ends badly."""

from __future__ import annotations

import os
import time

from isr_jax.errors import LibraryError


def work(task: str) -> str:
    """Do what the task says."""
    if task == "die":
        os._exit(3)
    if task == "hang":
        time.sleep(600)
    if task == "refuse":
        raise LibraryError("it is bad", "make it good")
    if task == "trip":
        raise ZeroDivisionError("by zero")
    if task == "nest":
        return work(task)
    return task.upper()
