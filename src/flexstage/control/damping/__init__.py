"""Active damping: loops of low authority in the legs, around which the loop of the pose is closed."""
