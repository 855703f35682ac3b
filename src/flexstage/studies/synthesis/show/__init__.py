"""How answers to a specification are shown."""
