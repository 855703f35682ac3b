"""Parameters of a batch: from the numbers that vary to the features of the model."""
