"""Finite elements, their reduction to superelements and the assembled model."""
