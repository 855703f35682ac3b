"""Feedforward for a known path: inverse of the loop, input shaping, iterative learning and repetitive control."""
