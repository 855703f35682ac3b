"""Linear systems of a loop: interconnection, sampling, norms."""
