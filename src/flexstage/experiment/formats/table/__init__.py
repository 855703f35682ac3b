"""CSV files: columns of numbers under a header that names channels and units."""
