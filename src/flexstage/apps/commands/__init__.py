"""Commands that describe a stage, analyse it and examine the installation, a module for each or for a few of a subject."""
