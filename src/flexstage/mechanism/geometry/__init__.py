"""Outlines of a stage: pieces, nearness and contact."""
