"""Common parts of all commands: options and their values, design files, results, progress, output files, exit codes."""
