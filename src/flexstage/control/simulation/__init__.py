"""Sampled time simulation of the nonlinear loop."""
