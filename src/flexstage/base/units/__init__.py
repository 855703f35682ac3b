"""Units, dimensions and quantities."""
