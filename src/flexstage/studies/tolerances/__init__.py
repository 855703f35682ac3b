"""Tolerances: scatter due to manufacture and material, yield, and allowable tolerances."""
