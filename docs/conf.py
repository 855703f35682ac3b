"""Sphinx configuration: MyST Markdown, furo theme; built with -W, so every warning is an error. Nothing is fetched."""

from __future__ import annotations

import flexstage

project = "flexstage"
author = "The flexstage authors"
copyright = "2026, the flexstage authors"
release = flexstage.__version__

extensions = ["myst_parser", "sphinx.ext.autodoc"]
myst_enable_extensions = ["colon_fence", "deflist"]  # formulas are plain text: MathJax would be fetched when a page is read
myst_heading_anchors = 3

# autodoc shows objects where they live, not where the lazy table hands them out.
autodoc_member_order = "bysource"
autodoc_typehints = "description"

html_theme = "furo"
html_title = "flexstage"
exclude_patterns = ["_build"]
suppress_warnings: list[str] = []
nitpicky = False
