"""Execution of a study: designs evaluated, stored and combined."""
