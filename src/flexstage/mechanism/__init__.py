"""Description of a stage: expansion into bodies and links, checks, and design file."""
