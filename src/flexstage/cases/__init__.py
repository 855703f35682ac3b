"""Shipped stages as functions from parameters to a description, and the catalogue."""
