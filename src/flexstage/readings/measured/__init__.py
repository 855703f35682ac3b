"""Measured reading: records of tests to spectra to modes."""
