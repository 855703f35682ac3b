"""Automatic modal identification from records."""
