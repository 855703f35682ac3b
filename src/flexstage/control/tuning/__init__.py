"""Tuning: the gains for a requested bandwidth, or the reason for failure."""
