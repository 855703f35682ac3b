"""A virtual controller: the loop of a stage that runs, and is spoken to over a socket."""
