"""Output-only modal identification."""
