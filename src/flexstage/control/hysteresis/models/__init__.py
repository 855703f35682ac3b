"""Hysteresis models and their inverse."""
