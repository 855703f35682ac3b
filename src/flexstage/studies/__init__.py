"""Studies: compositions of descriptions, readings and analyses."""
