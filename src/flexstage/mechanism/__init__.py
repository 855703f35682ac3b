"""The description of a stage, its expansion into bodies and links, its checks and its file."""
