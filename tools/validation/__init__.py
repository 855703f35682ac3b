"""Validation: every number of an authority against the one computed now, written to docs/validation (`make validation`)."""
