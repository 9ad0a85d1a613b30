"""Foreign CAD models, read and made into models of a library."""
