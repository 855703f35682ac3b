"""The stage as a solid picture: facets of bodies, links and gauges, sorted by depth and drawn in parallel projection."""
