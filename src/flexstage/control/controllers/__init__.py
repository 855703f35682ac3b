"""Controllers: from pose error to actuator commands."""
