"""Processes, memory, threads and compiled kernels."""
