"""Loop study of a stage: its set-up and all results."""
