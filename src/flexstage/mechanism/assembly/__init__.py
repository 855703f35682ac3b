"""Assembly of a description into bodies and links in the stage's frame."""
