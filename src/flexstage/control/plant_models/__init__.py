"""Plants of a loop: modes retained, electronics, coordinates."""
