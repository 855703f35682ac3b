"""Figures: results drawn with matplotlib's Figure objects (no pyplot, no global state), written as compact SVG or as PNG."""
