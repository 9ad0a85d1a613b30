"""The hand-held camera: its intrinsics, its way through a room, and how well it is known."""
