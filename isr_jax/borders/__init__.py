"""Borders to libraries that touch neither arrays nor gradients: embree, MuJoCo, pictures."""
