"""Pictures of the stage as solids: facets of bodies, links and gauges, sorted by depth, in parallel projection."""
