"""Grammar of descriptions: fields and values of each class."""
