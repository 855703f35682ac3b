"""Optimisation: the best design within ranges and limits, with exact derivatives."""
