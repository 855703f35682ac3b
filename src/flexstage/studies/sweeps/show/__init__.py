"""Tables, figures and reports of sweeps."""
