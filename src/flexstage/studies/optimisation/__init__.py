"""Optimise: the best design within ranges and limits, by exact derivatives."""
