"""`python -m tools.validation`: compute every page of docs/validation anew; leaves with 1 if something disagrees that is not recorded."""

from __future__ import annotations

import sys

from threadpoolctl import threadpool_limits

from tools.validation.page import chapters, unexpected, write

if __name__ == "__main__":
    with threadpool_limits(limits=1):
        found = chapters()
    write(found)
    for row in unexpected(found):
        print(" | ".join(row.cells()), file=sys.stderr)
    sys.exit(bool(unexpected(found)))
