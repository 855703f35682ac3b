"""Commands of the package `control`, one module each."""
