"""Commands of the solid wing, a module each, or one for those that belong together."""
