"""The studio shows a stage in a browser on this computer: a local server, the session of a design, and processes that compute."""
