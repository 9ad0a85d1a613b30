"""The command line ``isr``."""

from .main import main

__all__ = ["main"]
