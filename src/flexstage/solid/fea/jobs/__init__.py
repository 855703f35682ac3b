"""Jobs of the solid model: processes, memory and caches."""
