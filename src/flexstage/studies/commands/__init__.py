"""Commands of studies, one module each."""
