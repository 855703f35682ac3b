"""Loops and controllers as generated C, compiled and run."""
