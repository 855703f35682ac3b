"""Hysteresis and creep of piezo stacks: models, their inverse, their identification, and test plants of other models."""
