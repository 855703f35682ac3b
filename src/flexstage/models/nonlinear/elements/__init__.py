"""Elements at large displacements: flexures, links and fixed coordinates."""
