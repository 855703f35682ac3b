"""Loops for other programs: C, functional mock-up units, MATLAB."""
