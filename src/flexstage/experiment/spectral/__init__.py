"""Spectra, frequency responses and coherences of records."""
