"""The command line starts light, and optional packages may be missing."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = {
    "numba", "matplotlib", "scipy", "xarray", "pint", "shapely", "trimesh", "ezdxf",
    "networkx", "OCP", "pandas",
}  # fmt: skip

IMPORT_ALL = """
import importlib, pkgutil, sys
for hidden in ("OCP", "matplotlib", "trimesh", "ezdxf", "starlette", "uvicorn"):
    sys.modules[hidden] = None
import toothspace
for module in pkgutil.walk_packages(toothspace.__path__, "toothspace."):
    if not module.name.endswith("__main__"):
        importlib.import_module(module.name)
"""


def run(code: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run([sys.executable, "-c", code], capture_output=True, text=True)


@pytest.mark.parametrize("module", ["toothspace", "toothspace.cli"])
def test_start_is_light(module: str) -> None:
    done = run(f"import sys, {module}\nprint(*{{name.split('.')[0] for name in sys.modules}})")
    assert done.returncode == 0, done.stderr
    assert not HEAVY & set(done.stdout.split())


def test_package_imports_without_what_is_optional() -> None:
    done = run(IMPORT_ALL)
    assert done.returncode == 0, done.stderr


def test_run_of_a_machine_that_does_not_float_loads_nothing_that_does(repository: Path) -> None:
    done = run(
        "import sys, toothspace as ts\n"
        f"case = ts.load_case({str(repository / 'cases' / 'egm12_pump.toml')!r})\n"
        "ts.simulate(case.replace({'run.fidelity': 'lumped', 'run.revolutions': 1}))\n"
        "print([name for name in sys.modules if name.startswith('toothspace.floating')])\n"
    )
    assert done.stdout.split("\n")[-2] == "[]", done.stdout + done.stderr


def test_hiding_a_package_hides_it() -> None:
    done = run("import sys\nsys.modules['numpy'] = None\nimport numpy\n")
    assert done.returncode != 0


def test_step_file_without_its_package_is_refused_in_one_line(repository: Path) -> None:
    step = next((repository / "tests").rglob("*.st*p"), None)
    path = step or repository / "missing.step"
    done = run(
        "import sys\nfrom pathlib import Path\n"
        "sys.modules['OCP'] = None\n"
        "from toothspace.core.errors import GeometryError\n"
        "from toothspace.geometry.cad_import import SectionRequest, solid_sections\n"
        "try:\n"
        f"    solid_sections(Path({str(path)!r}), 1e-3, SectionRequest())\n"
        "except GeometryError as error:\n"
        "    print(error)\n"
    )
    assert done.returncode == 0, done.stderr
    assert "cadquery-ocp-novtk" in done.stdout or "toothspace[cad]" in done.stdout
    assert len(done.stdout.splitlines()) == 1
