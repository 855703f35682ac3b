"""What all commands share: options and their values, opening a design, answers, progress, output files, exit codes."""
