"""Pictures of the stage as solids: facets of bodies, links and gauges in parallel projection, drawn with a depth buffer."""
