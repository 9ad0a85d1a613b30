"""Experiments: each is a module that prints its table; ``python -m experiments.NAME --help``."""
