"""How the lines of ``src`` divide: ``python -m benchmarks.source_size benchmarks/results/size.md``.

Growth is counted between two commits, file by file; what no capability names is the house itself.
"""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections import Counter
from fnmatch import fnmatch
from pathlib import Path

SINCE = "cb2a7da"
"""Last commit before internal gears with crescent and before the packages were set anew."""
ROOT = "src/toothspace/"

CAPABILITIES: dict[str, tuple[str, ...]] = {
    "gears from CAD and measured gears": (
        *(f"geometry/{name}.py" for name in (
            "body_section", "cad_import", "gear_data", "gear_finder", "gear_profile",
            "involute_fit", "limited_reading", "profile_detection", "pump_sections",
            "reading_process", "step_*", "tooth_*",
        )),
        "machines/external_gear/own_teeth.py", "machines/external_gear/part_files.py",
        "machines/*/cad.py", "machines/gerotor/rotor_files.py",
        "core/lazy.py", "plotting/geometry.py",
    ),
    "validation book": ("validation/*", "report/validation_book.py"),
    "case model: checked on every construction, written back, all errors at once": (
        "case/*", "config/*", "core/keys.py", "core/frozen.py", "core/units.py",
    ),
    "compilation in seconds": ("core/comp*", "warmup.py", "solver/compiled_model.py"),
    "files, interrupts, warnings of results": (
        "core/files.py", "core/netcdf.py", "core/interrupts.py",
        "core/processes.py", "core/memory.py", "solver/accuracy.py", "results/solution.py",
        "results/file_layout.py", "results/credibility.py",
    ),
    "heat network": (
        "run/heating.py", "floating/heat.py", "closures/heat*",
    ),
    "losses by cause, ripple of the source, lines": (
        "results/ledger.py", "results/ripple.py", "results/performance.py",
        "studies/source_ripple.py",
    ),
    "notebooks, command line, report": (
        "cli/*", "report/*", "core/progress.py",
    ),
    "estimate of trapped pressure, bodies in an assembly": (
        "advice/trapping.py", "machines/external_gear/floating/balance.py",
    ),
    "mixing, roots, splines, second core": (
        *(f"numerics/{name}.py" for name in ("acceleration", "parallel", "roots", "spline")),
    ),
    "form in the browser": ("app/*",),
    "kinematics of many designs at once": (
        "machines/external_gear/designs.py", "geometry/*_designs.py", "studies/design_scan.py",
    ),
    "lateral films looked up at every instant": (
        "model/lateral_lo*.py", "model/lateral_table.py",
    ),
    "functional mock-up units": ("fmi/*",),
    "bodies that lift and tilt between covers": (
        "floating/between_covers.py",
    ),
    "flows of paths carried in slow machines": ("model/carried_flows.py",),
    "design rules of cross-port leakage": ("advice/trapping.py",),
    "internal gears with crescent": ("machines/crescent/*", "gearing/ring_*"),
}  # fmt: skip
"""What was added since, as patterns of its files below the package; the first that fits counts."""

HOUSE = "everything else: packages set anew, one description of film faces, shared gears"


def lines_at(commit: str) -> Counter[str]:
    """Lines of every module of a commit; of the files as they stand for an empty name."""
    if not commit:
        root = Path(ROOT)
        files = {str(p.relative_to(root)): p.read_text("utf-8") for p in root.rglob("*.py")}
        return Counter({name: text.count("\n") for name, text in files.items()})
    listed = _git("ls-tree", "-r", "--name-only", commit, ROOT).split()
    names = [name for name in listed if name.endswith(".py")]
    return Counter({n.removeprefix(ROOT): _git("show", f"{commit}:{n}").count("\n") for n in names})


def _git(*arguments: str) -> str:
    return subprocess.run(("git", *arguments), capture_output=True, text=True, check=True).stdout


def growth(before: Counter[str], now: Counter[str]) -> Counter[str]:
    """Lines that each capability has added."""
    added: Counter[str] = Counter()
    for name in before | now:
        fits = (
            c for c, patterns in CAPABILITIES.items() if any(fnmatch(name, p) for p in patterns)
        )
        added[next(fits, HOUSE)] += now[name] - before[name]
    return added


def helpers() -> tuple[int, int]:
    """Private functions whose name stands once beside its definition, and all functions."""
    once = total = 0
    for path in Path(ROOT).rglob("*.py"):
        text = path.read_text("utf-8")
        words = Counter(re.findall(r"\b_\w+\b", text))
        for node in ast.walk(ast.parse(text)):
            if isinstance(node, ast.FunctionDef):
                total += 1
                once += not node.name.startswith("__") and words[node.name] == 2
    return once, total


def page() -> str:
    """Page of the manual."""
    before, now = lines_at(SINCE), lines_at("")
    added = growth(before, now)
    rows = [f"| {name} | {count:+d} |" for name, count in added.most_common()]
    once, functions = helpers()
    house = added[HOUSE] + added["internal gears with crescent"]
    return "\n".join([
        "# Size of the source",
        "",
        f"`src` had {before.total()} lines before the packages were set anew (commit {SINCE}), and",
        f"it has {now.total()} now. `benchmarks/source_size.py`, which wrote this page, says which",
        "file counts for what.",
        "",
        "| what | lines |",
        "|---|---|",
        *rows,
        f"| sum | {now.total() - before.total():+d} |",
        "",
        f"The packages set anew come to {house:+d} lines, a third machine included; the rest is",
        "what the program can do since. The whole source is larger than it was.",
        "",
        f"Private functions used once: {once} of {functions}, {100.0 * once / functions:.1f} %.",
        "",
    ])  # fmt: skip


if __name__ == "__main__":
    Path(sys.argv[1]).write_text(page(), encoding="utf-8")
