"""Amplifiers and floor vibration of a set-up."""
