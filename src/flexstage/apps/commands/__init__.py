"""Commands that describe a stage, analyse it and examine the installation, one module for each subject."""
