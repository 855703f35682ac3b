"""Applications: translate requests; no physics."""
