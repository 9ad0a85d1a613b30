"""Pictures of models, one or a whole library on a sheet, by ray casting."""

from .sheet import draw_model, draw_models

__all__ = ["draw_model", "draw_models"]
