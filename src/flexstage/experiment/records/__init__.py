"""Records of tests: channels, units, clocks and their health."""
