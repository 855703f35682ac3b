"""Model updating: the numbers that make theory agree with a test."""
