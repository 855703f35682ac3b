"""Tables of every result, one file for each result: each function takes a result and returns a `Table` (or several)."""
