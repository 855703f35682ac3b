"""Active damping: inner loops in the legs (low authority), inside the pose loop (high authority)."""
