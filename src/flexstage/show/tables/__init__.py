"""Tables of every result, one file a result: each function takes a result and returns a `Table` (or several)."""
