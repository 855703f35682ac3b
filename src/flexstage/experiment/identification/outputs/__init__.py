"""Modes from outputs without recorded inputs."""
