"""Batch solution of the lumped model: platform frequencies and their derivatives for many designs, by blocks on the graph of bodies."""
