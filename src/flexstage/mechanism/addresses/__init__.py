"""Addresses of values in a description."""
