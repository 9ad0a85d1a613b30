"""``python -m isr_jax`` is ``isr``."""

from .cli import main

main()
