"""Tables, figures and reports: reads results, never computes."""
