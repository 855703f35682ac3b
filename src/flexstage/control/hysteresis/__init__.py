"""Hysteresis and creep of piezo stacks: models, their inverse and identification, and other models as test plants."""
