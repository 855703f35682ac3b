"""Test records: channels, units, clocks and checks."""
