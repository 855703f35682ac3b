"""The studio: a stage in a page of this computer's browser. A server on the loopback, the session of a design, computing processes."""
