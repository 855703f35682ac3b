"""Batch solution of the lumped model: platform frequencies of many designs and their derivatives, by block elimination of the bodies."""
