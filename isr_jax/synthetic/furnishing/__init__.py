"""Furnishing: which models stand where in a room, by recipe; pure geometry and chance."""
