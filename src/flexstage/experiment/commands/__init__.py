"""Commands of the experiment wing, a module each."""
