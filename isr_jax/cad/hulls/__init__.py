"""Convex collision hulls for meshes: split, decomposed, merged, measured, parted."""
