"""Common parts of all commands: options and their values, design files, results, progress bars, output files, exit codes."""
