"""Studies of many designs: what is varied, what is asked, how designs are planned, computed and kept."""
