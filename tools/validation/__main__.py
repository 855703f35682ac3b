"""`python -m tools.validation [--solids]`: compute the pages of docs/validation anew, with `--solids` the one of solids as well.

Leaves with 1 if something disagrees that is not recorded.
"""

from __future__ import annotations

import sys

from threadpoolctl import threadpool_limits

from tools.validation.page import chapters, solid_chapter, unexpected, write

if __name__ == "__main__":
    with threadpool_limits(limits=1):
        found = chapters()
        more = [solid_chapter()] if "--solids" in sys.argv[1:] else []
    write(found, more)
    for row in unexpected([*found, *more]):
        print(" | ".join(row.cells()), file=sys.stderr)
    sys.exit(bool(unexpected([*found, *more])))
