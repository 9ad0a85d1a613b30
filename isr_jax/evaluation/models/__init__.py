"""Measures of CAD replacement: retrieval, alignment, Chamfer, functional equivalence."""
