"""Outlines of a stage: convex pieces, proximity and contact."""
