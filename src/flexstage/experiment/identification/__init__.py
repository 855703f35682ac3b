"""Modes from records, found without a hand."""
