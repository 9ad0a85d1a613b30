"""Measures of maps: panoptic quality, instances, boxes, surface."""
