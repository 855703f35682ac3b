"""Functional mock-up units: programs of loops for other simulators."""
