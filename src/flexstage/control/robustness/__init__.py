"""Stability and margins of a loop."""
