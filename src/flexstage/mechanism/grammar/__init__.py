"""The grammar of descriptions: the values that each class holds."""
