"""Functional mock-up units: loop programs for other simulators."""
