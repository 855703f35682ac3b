"""The stage as one mesh that moves: data of the viewer that pages, notebooks and the studio share, and its page."""
