"""Our class a pixel from the output of a semantic model."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

from .model_image import to_image
from .sidecar import Sidecar

_UNKNOWN_CONFIDENCE = 0.75
"""Of models that say the class alone."""


def class_maps(
    output: np.ndarray, sidecar: Sidecar, shape: tuple[int, int]
) -> tuple[Int[np.ndarray, "height width"], Float[np.ndarray, "height width"]]:
    """Our class a pixel of an image of ``shape``, and the confidence in it.

    ``labels`` outputs [h, w] know no confidence: it is 0.75 everywhere. That of ``logits``
    [classes, h, w] (or [h, w, classes]) is the soft-max of the best.
    """
    table = np.array(sidecar.class_of, np.int32)
    if sidecar.decoder == "labels":
        label = to_image(output.astype(np.int16), sidecar, shape, smooth=False)
        return table[label], np.full(shape, _UNKNOWN_CONFIDENCE, np.float32)
    logits = output.transpose(2, 0, 1) if sidecar.outputs["output"].layout == "NHWC" else output
    logits = logits.astype(np.float32)
    label = logits.argmax(0)
    top = np.take_along_axis(logits, label[None], 0)
    confidence = (1.0 / np.exp(logits - top).sum(0)).astype(np.float32)
    # Edges come from depth: classes are enlarged without smoothing.
    label = to_image(label.astype(np.int16), sidecar, shape, smooth=False)
    return table[label], to_image(confidence, sidecar, shape, smooth=True)
