"""How much of each instance a frame shows, as a rendered sequence knows it."""

from __future__ import annotations

import dataclasses
import hashlib
import json
from pathlib import Path

from ..errors import SegmenterError

_HINT = "render the sequence again, or take truth/views.json away: occlusion then is not known"


@dataclasses.dataclass(frozen=True)
class TrueViews:
    """Visible and unoccluded pixels by frame and instance."""

    shares: dict[str, dict[int, float]]
    """Visible share of what the image would show of an instance if nothing stood before it."""
    content_hash: str

    def visible_shares(self, frame_name: str) -> dict[int, float]:
        """By instance; empty for a frame that is not listed."""
        return self.shares.get(frame_name, {})


def read_true_views(path: Path) -> TrueViews | None:
    """Read ``truth/views.json``; None where there is none.

    Raises:
        SegmenterError: the file is not of the format.
    """
    try:
        data = path.read_bytes()
    except FileNotFoundError:
        return None
    except OSError as error:
        raise SegmenterError(f"{path}: {error.strerror}", _HINT) from None
    try:
        frames = json.loads(data)["frames"]
        shares = {
            name: {
                int(id): view["visible_px"] / max(view["unoccluded_px"], 1)
                for id, view in views.items()
            }
            for name, views in frames.items()
        }
    except (ValueError, TypeError, KeyError, AttributeError) as error:
        problem = f"{path} is not of the format: {type(error).__name__} {error}"
        raise SegmenterError(problem, _HINT) from None
    return TrueViews(shares, hashlib.sha256(data).hexdigest())
