"""``python -m toothspace``."""

from __future__ import annotations

import sys

from toothspace.cli import main

if __name__ == "__main__":
    sys.exit(main())
