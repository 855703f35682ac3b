"""Tolerances: what manufacture and material do to a design, how many stages keep their specification, and what that allows."""
