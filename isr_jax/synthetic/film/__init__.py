"""Filming: frames, true labels, what each frame shows, and the sequence on disk."""
