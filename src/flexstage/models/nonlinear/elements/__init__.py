"""Elements at large displacements: flexures, links and held coordinates."""
