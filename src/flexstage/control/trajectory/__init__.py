"""Trajectories: reference motions of the platform."""
