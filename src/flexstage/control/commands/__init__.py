"""Commands of the control wing, a module each."""
