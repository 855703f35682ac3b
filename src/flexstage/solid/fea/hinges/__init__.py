"""6x6 compliance matrices of hinges by finite elements."""
