"""The virtual test rig: a stage shaken by noise and measured, as a record."""
