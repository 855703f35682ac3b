"""The 6x6 of hinges by finite elements."""
