"""The sections of a report, one file a theme: each takes a complete analysis and returns a section, or None without its results."""
