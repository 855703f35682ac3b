"""Modes and frequency responses."""
