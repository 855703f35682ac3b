"""Hysteresis and creep of piezo stacks: models, their inverse, their identification, and plants of another kind."""
