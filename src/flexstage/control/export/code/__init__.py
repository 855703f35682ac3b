"""Loops and controllers as C: generated, compiled and run."""
