"""The lumped model of many designs at once: platform frequencies and their derivatives, block by block on the graph of bodies."""
