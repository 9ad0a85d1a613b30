"""Readers: what foreign files say, unchanged."""
