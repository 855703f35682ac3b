"""Ground floor: numbers, units, findings, digests and labelled arrays. Knows nothing of mechanics."""
