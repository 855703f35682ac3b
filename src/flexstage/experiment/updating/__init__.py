"""Model updating: parameters that make the model agree with a test."""
