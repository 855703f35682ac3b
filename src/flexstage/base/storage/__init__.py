"""Files, documents, digests and stores."""
