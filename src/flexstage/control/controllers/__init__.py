"""Controllers: from the error of the pose to the actuators' commands."""
