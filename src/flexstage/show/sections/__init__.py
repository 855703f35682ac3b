"""Sections of a report, one file for each subject: each function takes a complete analysis and returns a section, or `None`."""
