"""Compliance and mass of parts by beam theory."""
