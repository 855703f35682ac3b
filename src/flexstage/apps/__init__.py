"""User interfaces: the command line and the studio. They contain no physics."""
