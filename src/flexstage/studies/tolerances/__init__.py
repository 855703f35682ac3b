"""Tolerances: scatter of manufacture and material, yield of the specification, and allowable tolerances."""
