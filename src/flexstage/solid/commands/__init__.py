"""Commands of the solid model, one module for each group."""
