# netgen brings no types: its modules are tables of a compiled library.
