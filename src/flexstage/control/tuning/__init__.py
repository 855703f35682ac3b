"""Tuning: the gains that bring a loop to a wanted bandwidth, or the reason why none do."""
