"""Commands of the studies wing, a module each."""
