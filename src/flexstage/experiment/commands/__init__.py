"""Commands of the package `experiment`, one module each."""
