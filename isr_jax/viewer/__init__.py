"""Stage ``viewer``: results -> a page in the browser to look at it all."""

from .server import build_view, view

VERSION: int = 1

__all__ = ["VERSION", "build_view", "view"]
