"""Files of tests, read and written: CSV, UFF, HDF5, MAT."""
