"""Makers of furniture, and the rows of the default set."""
