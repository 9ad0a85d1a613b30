"""Shapes that convex solids make: turned, blown, bent."""
