"""Plants of a loop: retained modes, electronics, coordinates."""
