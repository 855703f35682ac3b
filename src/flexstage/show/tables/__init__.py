"""Tables of results, one file for each kind of result: each function takes a result and returns a `Table` (or several)."""
