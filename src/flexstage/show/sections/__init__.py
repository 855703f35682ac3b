"""The sections of a report, one file for each subject: each takes a complete analysis and returns a section, or `None`."""
