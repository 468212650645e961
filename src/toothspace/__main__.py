"""``python -m toothspace``."""

from __future__ import annotations

import sys

if __name__ == "__main__":
    if not sys.flags.safe_path:
        # the current folder, which Python put first: its files are no part of the program
        sys.path.append(sys.path.pop(0))
    from toothspace.cli import main

    sys.exit(main())
