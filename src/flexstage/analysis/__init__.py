"""Analyses: from models to results."""
