"""Boxes with masks from the two outputs of a YOLO segmentation head."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

from .boxes import Boxes, best_class, suppress, to_pixels
from .model_image import to_image
from .sidecar import Sidecar


def decode_yolo_seg(
    outputs: dict[str, Float[np.ndarray, "..."]],
    sidecar: Sidecar,
    shape: tuple[int, int],
    *,
    min_score: float,
) -> Boxes:
    """Boxes and masks in pixels of an image of ``shape``, best first.

    A cell is centre, size, one score per class, and p coefficients; its mask is where the sum of
    the prototypes times the coefficients is positive (a logit; Bolya et al. 2019), cut off at the
    box. Suppression is over all classes at once, as in `boxes.decode_yolox`.

    Args:
        outputs: ``cells`` [4 + classes + p, cells] and ``prototypes`` [p, h, w] (or [h, w, p]).
        sidecar: Of the model.
        shape: Height and width of the image.
        min_score: Weaker boxes are left out.
    """
    labels = len(sidecar.class_of)
    cells = outputs["cells"].astype(np.float32)
    # Most cells see nothing: they go before anything else is computed.
    cells = cells[:, cells[4 : 4 + labels].max(0) >= min_score].T
    class_id, score = best_class(cells[:, 4 : 4 + labels], sidecar)
    cells, score, class_id = (v[class_id > 0] for v in (cells, score, class_id))
    unit = np.ones(2)
    if sidecar.outputs["cells"].box_unit == "share":
        unit = np.array(sidecar.input_size[::-1])
    xyxy = to_pixels(cells[:, :2] * unit, cells[:, 2:4] * unit, sidecar, shape)
    order = suppress(xyxy, score)
    xyxy, coefficients = xyxy[order], cells[order, 4 + labels :]
    masks = _masks(coefficients, _prototypes(outputs, sidecar), xyxy, sidecar, shape)
    return Boxes(xyxy, class_id[order], score[order].astype(np.float32), masks)


def _prototypes(outputs: dict[str, np.ndarray], sidecar: Sidecar) -> np.ndarray:
    found = outputs["prototypes"].astype(np.float32)
    return found.transpose(2, 0, 1) if sidecar.outputs["prototypes"].layout == "NHWC" else found


def _masks(
    coefficients: Float[np.ndarray, "boxes p"],
    prototypes: Float[np.ndarray, "p h w"],
    xyxy: Float[np.ndarray, "boxes 4"],
    sidecar: Sidecar,
    shape: tuple[int, int],
) -> Bool[np.ndarray, "boxes height width"]:
    """All logits in one product; each is enlarged only within its box."""
    masks = np.zeros((len(xyxy), *shape), bool)
    logits = np.tensordot(coefficients, prototypes, 1)
    low, high = np.floor(xyxy[:, :2]).astype(int), np.ceil(xyxy[:, 2:]).astype(int)
    for mask, logit, (x0, y0), (x1, y1) in zip(masks, logits, low, high, strict=True):
        if x1 > x0 and y1 > y0:
            window = (int(x0), int(y0), int(x1), int(y1))
            mask[y0:y1, x0:x1] = to_image(logit, sidecar, shape, smooth=True, window=window) > 0
    return masks
