"""Border: connected components of images (OpenCV)."""

from __future__ import annotations

import cv2
import numpy as np
from jaxtyping import Bool, Int


def connected_components(
    mask: Bool[np.ndarray, "height width"],
) -> tuple[Int[np.ndarray, "height width"], Int[np.ndarray, " components"]]:
    """Components of 4 neighbours: a label per pixel (0 = outside) and the pixels of each label."""
    count, label = cv2.connectedComponents(
        np.ascontiguousarray(mask, np.uint8), connectivity=4, ltype=cv2.CV_32S
    )
    label = np.asarray(label, np.int32)
    area = np.bincount(label.ravel(), minlength=count)
    area[0] = 0
    return label, area
