"""Makers of small things, plants, lamps, doors and windows, and the rows of the default set."""
