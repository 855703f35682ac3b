"""Models: pure functions from a description to a model."""
