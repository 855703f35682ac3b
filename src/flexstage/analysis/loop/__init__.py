"""The control loop: from reference command to nanometres."""
