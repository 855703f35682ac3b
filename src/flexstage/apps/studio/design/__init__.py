"""The text of a design in the studio: reading, writing, history."""
