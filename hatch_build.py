"""Build hook: a wheel carries the library of compiled code.

Without a C compiler, or with ``TOOTHSPACE_LIBRARY=none``, a wheel of Python alone can be built,
which compiles at run time with the extra ``jit``.
"""

from __future__ import annotations

import os
import platform
import re
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class LibraryHook(BuildHookInterface):
    """Compiles the library before the files of a wheel are collected."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Build the library and name the platform of the wheel."""
        if version == "editable" or os.environ.get("TOOTHSPACE_LIBRARY") == "none":
            return
        root = Path(self.root)
        paths = [str(root / "src"), os.environ.get("PYTHONPATH", "")]
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, paths))}
        command = [sys.executable, "-m", "native.build"]
        subprocess.run(command, cwd=root, env=environment, check=True)
        for path in sorted((root / "src" / "toothspace" / "native").iterdir()):
            if not path.name.startswith("."):
                build_data["force_include"][str(path)] = f"toothspace/native/{path.name}"
        system = sysconfig.get_platform().replace("universal2", platform.machine())
        build_data["pure_python"] = False
        build_data["tag"] = f"cp311-abi3-{re.sub('[-.]', '_', system)}"
