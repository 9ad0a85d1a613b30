"""The built-in demonstration: a room that stands, filmed, reconstructed and scored."""
