"""Frames, twists and wrenches: component order, reference point and 6x6 transport are defined here only."""
