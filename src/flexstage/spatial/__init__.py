"""Frames, twists and wrenches: the only home of component order, reference point and 6x6 transport."""
