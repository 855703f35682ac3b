"""Meshes, how fine they are, and the errors that their sequence shows."""
