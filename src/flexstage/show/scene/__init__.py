"""The stage as a solid picture: facets of bodies, links and gauges, sorted by depth, in parallel projection."""
