"""Trajectories: what the platform is asked to do."""
