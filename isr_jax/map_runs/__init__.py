"""From frames to panoptic maps: a sequence on disk, or a live camera."""
