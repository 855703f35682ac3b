"""The loop of a stage as a whole: its set-up, and everything that follows from it."""
