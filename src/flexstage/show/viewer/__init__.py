"""Viewer of a stage as one moving mesh: its data for pages, notebooks and the studio, and its HTML page."""
