"""Virtual controller: the running loop of a stage, controlled over a socket."""
