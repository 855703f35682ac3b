"""What is commanded along a known path: inverse of the loop, input shaping, learning from pass to pass."""
