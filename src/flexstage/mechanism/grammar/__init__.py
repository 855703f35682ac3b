"""Grammar of descriptions: the fields of each class and the kinds of their values."""
