"""The stage as one moving mesh: data of the viewer for pages, notebooks and the studio, and its page."""
