"""Base layer: numbers, units, errors, digests and labelled arrays; independent of mechanics."""
