"""Spoils one line after another and asks the tests whether they notice: ``make mutants``.

``python -m benchmarks.mutants`` puts every spoiled line of the list below into a copy of the
package and runs the behaviour tests of its room there, without stored numbers. ``--random N`` draws
further lines: an operator of a formula exchanged, or a constant a tenth larger, in ``--room``.
``--wider`` asks verification and stored numbers where these see nothing. Each copy has a cache of
its own but for compiled code, whose files are named by what they are made of.

``--coverage FILE`` asks single tests of the whole fast suite in copies of one warm process, which
takes seconds a line: those that execute the spoiled statement, near ones and the quickest first,
then the others of their files and of those that name the module; stored numbers last. FILE is the
data of coverage.py with a context for every test, as ``pytest --cov=toothspace --cov-context=test``
of pytest-cov writes it, and ``--durations`` the report of ``--junitxml`` of the same run. Compiled
code is not in it: such lines, and what runs as a module is imported, go the longer way.

The table says which test saw what; ``-o`` keeps it as JSON, and a command that was stopped goes on
where it was.
"""

from __future__ import annotations

import argparse
import ast
import json
import os
import random
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache, partial
from pathlib import Path

from benchmarks.warm_tests import REPOSITORY, WarmTests, own_cache, with_warm_tests

SOURCES = REPOSITORY / "src" / "toothspace"
LIMIT = 900.0
"""Longest time for the tests of one spoiled line: a march without end is noticed, too. [s]"""
FAILED = (1, 2)
"""Exit codes of tests that failed, or that could not be read with the spoiled line."""
MOST_SILENT = 5
"""Tests that may fail for another reason, as where they need more than a copy of the package."""
ROOMS = {
    "closures": ("unit/closures", "properties/test_closure_*"),
    "circuit": ("unit/circuit",),
    "films": ("properties/test_film_*", "unit/films", "verification/test_journal_film.py"),
    "floating": ("unit/floating",),
    "fmi": ("unit/fmi",),
    "gearing": (
        "properties/test_machine_similarity.py",
        "properties/test_external_gear_*",
        "unit/gearing",
        "unit/geometry/test_geometry_gear_pair.py",
        "verification/test_machine_contract.py",
        "verification/test_crescent_geometry.py",
    ),
    "geometry": ("unit/geometry",),
    "machines": (
        "properties/test_machine_similarity.py",
        "properties/test_external_gear_*",
        "verification/test_machine_contract.py",
        "unit/machines",
        "unit/gearing",
    ),
    "model": (
        "properties/test_machine_similarity.py",
        "unit/model",
        "verification/test_oracle.py",
        "unit/solver",
    ),
    "numerics": ("unit/numerics",),
    "results": ("unit/results", "unit/cli/test_export.py", "verification/test_noise.py"),
    "solver": (
        "unit/solver",
        "verification/test_machine_physics.py",
        "verification/test_oracle.py",
        "unit/run",
    ),
}
"""Behaviour tests of each package, which compare with no stored number; before them those of all
that name the module of the line."""
BEHAVIOUR = ("unit", "properties", "verification")
WIDER = (*BEHAVIOUR, "regression")
"""What of the fast suite is asked where these see nothing; stored numbers last."""

OPERATORS = {ast.Add: "-", ast.Sub: "+", ast.Mult: "/", ast.Div: "*", ast.Lt: ">", ast.Gt: "<"}
"""What stands in place of an operator."""


@dataclass(frozen=True)
class Mutant:
    """A line that is spoiled."""

    file: str
    """File below the package."""
    before: str
    """Text that stands there once."""
    after: str
    """Text in its place."""
    tests: tuple[str, ...]
    """Files or folders of tests that must notice."""
    place: int = -1
    """Where the text begins; found by the text if negative."""

    def spoiled(self, text: str) -> str:
        """Source with this line spoiled."""
        place = self.place if self.place >= 0 else text.index(self.before)
        if self.place < 0 and text.count(self.before) != 1:
            raise ValueError(f"{self.file}: {self.before!r} stands {text.count(self.before)} times")
        return text[:place] + self.after + text[place + len(self.before) :]


MUTANTS = (
    Mutant(
        "model/chambers.py",
        "energy = 0.5 * node[col.WALL_COMPLIANCE]",
        "energy = 0.55 * node[col.WALL_COMPLIANCE]",
        ("unit/model/test_wall_energy.py",),
    ),
    Mutant(
        "films/reynolds/equation.py",
        "rate = open_part * change.rate[i, j] + curve",
        "rate = open_part * change.rate[i, j] - curve",
        ("unit/films/test_film_derivatives.py",),
    ),
    Mutant(
        "films/journal/solution.py",
        "self.power_loss + self.solved.exchange.power",
        "self.power_loss - self.solved.exchange.power",
        ("unit/films/test_film_derivatives.py",),
    ),
    Mutant(
        "gearing/flank_contacts.py",
        "teeth.sort(key=lambda tooth: -tooth[1])",
        "teeth.sort(key=lambda tooth: tooth[1])",
        ("unit/gearing/test_tooth_flexibility.py",),
    ),
    Mutant(
        "machines/crescent/flow_paths.py",
        "2.0 * notch.width * depth / (notch.width + depth)",
        "4.0 * notch.width * depth / (notch.width + depth)",
        ("unit/machines/test_crescent_notch.py",),
    ),
    Mutant(
        "closures/accumulator.py",
        "gas_volume * precharge / (polytropic_exponent - 1.0)",
        "gas_volume * precharge / (polytropic_exponent + 1.0)",
        ("unit/model/test_wall_energy.py",),
    ),
    Mutant(
        "films/reynolds/state.py",
        "power -= float((out * pressure)",
        "power += float((out * pressure)",
        ("unit/films/test_film_derivatives.py",),
    ),
    Mutant(
        "solver/flow_regime.py",
        "np.asarray(2.0 * np.abs(mass_flow)",
        "np.asarray(1.0 * np.abs(mass_flow)",
        ("unit/solver/test_flow_regime.py",),
    ),
    Mutant(
        "solver/flow_regime.py",
        "first += element.states",
        "first += 1",
        ("unit/solver/test_flow_regime.py",),
    ),
    Mutant(
        "advice/findings.py",
        "highest = float(np.sqrt(2.0 * low",
        "highest = float(np.sqrt(4.0 * low",
        ("unit/advice/test_limits.py",),
    ),
    Mutant(
        "advice/gear_rules.py",
        "passed=least <= backlash <= most",
        "passed=backlash <= most",
        ("unit/advice/test_trapping.py",),
    ),
    Mutant(
        "case/conditions.py",
        "20_000_000 if over_time else 4_000_000",
        "20_000_000",
        ("unit/case/test_step_limit.py",),
    ),
)
"""Lines that a reader once spoiled, and that no fast test had seen, with newer ones."""


def random_mutants(count: int, seed: int, rooms: Sequence[str]) -> Iterator[Mutant]:
    """Draw spoiled operators and constants in formulas of the rooms."""
    draw = random.Random(seed)
    known = set[tuple[str, int]]()
    for _ in range(count):
        chosen = draw.choice(rooms)
        file = draw.choice(sorted((SOURCES / chosen).rglob("*.py")))
        text = file.read_text(encoding="utf-8")
        found = list(_places(text))
        if found:
            place, before, after = draw.choice(found)
            name = file.relative_to(SOURCES).as_posix()
            if (name, place) in known:
                continue
            known.add((name, place))
            yield Mutant(name, before, after, ROOMS[chosen], place)


def _places(text: str) -> Iterator[tuple[int, str, str]]:
    """Where operators and constants of formulas stand, and what may stand there instead."""
    lines = [0]
    for line in text.splitlines(keepends=True):
        lines.append(lines[-1] + len(line))

    def at(line: int, column: int) -> int:
        return lines[line - 1] + len(text.splitlines()[line - 1].encode()[:column].decode())

    formulas = [node for node in ast.walk(ast.parse(text)) if isinstance(node, ast.FunctionDef)]
    for function in formulas:
        for node in ast.walk(function):
            operands: list[tuple[ast.expr, ast.AST, ast.expr]] = []
            if isinstance(node, ast.BinOp):
                operands = [(node.left, node.op, node.right)]
            elif isinstance(node, ast.Compare) and len(node.ops) == 1:
                operands = [(node.left, node.ops[0], node.comparators[0])]
            for left, operator, right in operands:
                sign = OPERATORS.get(type(operator))
                begin = at(left.end_lineno or 0, left.end_col_offset or 0)
                between = text[begin : at(right.lineno, right.col_offset)]
                if sign and len(between.strip(" ()\n")) == 1:
                    yield begin, between, between.replace(between.strip(" ()\n"), sign)
            if isinstance(node, ast.Constant) and isinstance(node.value, float) and node.value:
                begin, end = (
                    at(node.lineno, node.col_offset),
                    at(node.lineno, node.end_col_offset or 0),
                )
                yield begin, text[begin:end], repr(1.1 * node.value)


@dataclass(frozen=True)
class Verdict:
    """What the tests said of a spoiled line."""

    mutant: Mutant
    outcome: str
    """``killed`` or ``timed out``, which are noticed; ``survived``, ``not executed`` by any test,
    ``unfinished`` where tests are left to ask, ``not judged``."""
    test: str
    """First test that failed."""
    seconds: float


NOTICED = ("killed", "timed out")
"""Outcomes of lines that tests notice."""


def files_of(folders: Iterable[str]) -> list[Path]:
    """Test files of folders or patterns below the tests."""
    found: dict[Path, None] = {}
    for folder in folders:
        for path in sorted((REPOSITORY / "tests").glob(folder)):
            found |= dict.fromkeys(sorted(path.rglob("test_*.py")) if path.is_dir() else [path])
    return list(found)


def naming(mutant: Mutant) -> list[str]:
    """Test files that name the module of a spoiled line."""
    package, module = mutant.file.removesuffix(".py").replace("/", ".").rpartition(".")[::2]
    named = re.compile(rf"{re.escape(package)}(\.| import .*\b){module}\b")
    found = [file for file in files_of(BEHAVIOUR) if named.search(file.read_text("utf-8"))]
    return [file.relative_to(REPOSITORY).as_posix() for file in found]


def nearest_first(mutant: Mutant) -> list[str]:
    """Test files of a spoiled line, those that name its module before the others."""
    room = [file.relative_to(REPOSITORY).as_posix() for file in files_of(mutant.tests)]
    return list(dict.fromkeys([*(naming(mutant) if mutant.place >= 0 else ()), *room]))


COMPILED = {"kernel", "_kernel", "summing_kernel", "njit", "merged", "inlined", "overload"}
"""Marks of functions that run compiled, where no coverage is measured."""


def statement(mutant: Mutant) -> tuple[range, bool]:
    """Lines of a spoiled statement, of one with a body the head, and whether it is compiled."""
    text = (SOURCES / mutant.file).read_text(encoding="utf-8")
    line = text[: mutant.place].count("\n") + 1
    around = [
        node
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.stmt) and node.lineno <= line <= (node.end_lineno or 0)
    ]
    marks = {
        getattr(mark.func if isinstance(mark, ast.Call) else mark, "id", "")
        for node in around
        if isinstance(node, ast.FunctionDef)
        for mark in node.decorator_list
    }
    closest = min(around, key=lambda node: (node.end_lineno or 0) - node.lineno)
    body = getattr(closest, "body", None)
    end = max(closest.lineno + 1, body[0].lineno) if body else (closest.end_lineno or 0) + 1
    return range(closest.lineno, end), bool(marks & COMPILED)


def executing(mutant: Mutant, data: Path) -> set[str]:
    """Tests that execute a spoiled statement; an empty name where it runs beside them."""
    by_line = contexts(data, mutant.file)
    lines = statement(mutant)[0]
    return {context.partition("|")[0] for line in lines for context in by_line.get(line, ())}


@cache
def contexts(data: Path, file: str) -> dict[int, list[str]]:
    """Names of what executes each line of a file. Raises ImportError without coverage.py."""
    from coverage import CoverageData

    kept = CoverageData(str(data))
    kept.read()
    found: dict[int, list[str]] = {}
    for measured in kept.measured_files():
        if measured.endswith(f"/toothspace/{file}"):
            for line, names in kept.contexts_by_lineno(measured).items():
                found.setdefault(line, []).extend(names)
    return found


def file_of(test: str) -> str:
    """File of a test."""
    return test.partition("::")[0]


def quickly_judged(mutant: Mutant, data: Path, warm: WarmTests) -> Verdict:
    """Ask single tests of a spoiled line in copies of this process; else as :func:`judged`."""
    if statement(mutant)[1]:
        return judged(mutant)
    started = time.perf_counter()
    execute = executing(mutant, data)
    named = {*naming(mutant)}
    files = {file_of(test) for test in execute}
    groups = [
        [test for test in execute if file_of(test) in named],
        execute,
        [test for test in warm.items if file_of(test) in files | named],
    ]
    asked = dict.fromkeys(test for group in groups for test in warm.quickest_first(group))
    order = sorted(asked, key=lambda test: test.startswith("tests/regression"))
    source = SOURCES / mutant.file
    spoiled = mutant.spoiled(source.read_text(encoding="utf-8"))
    outcome, test = warm.answer(source, spoiled, order)
    if not outcome or (outcome == "survived" and execute == {""}):
        return judged(mutant)
    if outcome == "survived" and not execute:
        outcome = "not executed"
    return Verdict(mutant, outcome, test, time.perf_counter() - started)


def judged(mutant: Mutant) -> Verdict:
    """Run the tests of a spoiled line against a copy of the package.

    A test that fails is asked again with the line as it was: one that then fails as well, or cannot
    be read, says nothing of the line, and the others go on without it.
    """
    started = time.perf_counter()
    asked = nearest_first(mutant)
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "toothspace"
        own_cache(Path(folder))
        shutil.copytree(SOURCES, copy, ignore=shutil.ignore_patterns("__pycache__"))
        shutil.copytree(REPOSITORY / "cases", copy / "shipped" / "cases")
        file = copy / mutant.file
        whole = file.read_text(encoding="utf-8")
        silent = list[str]()
        while True:
            file.write_text(mutant.spoiled(whole), encoding="utf-8")
            code, test = asked_of(asked, copy.parent, silent)
            if code not in FAILED or not test or len(silent) >= MOST_SILENT:
                break
            file.write_text(whole, encoding="utf-8")
            if asked_of([test], copy.parent)[0] == 0:
                break
            silent.append(test)
        outcome = {0: "survived", None: "timed out"}.get(code, "not judged")
        if code in FAILED and test and len(silent) < MOST_SILENT:
            outcome = "killed"
    return Verdict(mutant, outcome, test, time.perf_counter() - started)


def asked_of(tests: list[str], folder: Path, without: Iterable[str] = ()) -> tuple[int | None, str]:
    """Exit code of tests on the package in a folder, none if without end; the one that failed."""
    environment = {
        **os.environ,
        "PYTHONPATH": str(folder),
        "TOOTHSPACE_CACHE": str(folder / "cache"),
        "PYTHONDONTWRITEBYTECODE": "1",
    }
    command = [sys.executable, "-m", "pytest", "-q", "-x", "-p", "no:cacheprovider", *tests]
    command += [f"--deselect={test}" for test in without]
    try:
        done = subprocess.run(
            command,
            cwd=REPOSITORY,
            env=environment,
            capture_output=True,
            text=True,
            timeout=LIMIT,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return None, ""
    lines = [line for line in done.stdout.splitlines() if line.startswith(("FAILED", "ERROR"))]
    return done.returncode, lines[0].split(" - ")[0].split(" ", 1)[1] if lines else ""


def read(path: Path | None) -> list[Verdict]:
    """Verdicts that were kept before."""
    if path is None or not path.exists():
        return []
    kept = json.loads(path.read_text(encoding="utf-8"))
    return [Verdict(**{**one, "mutant": Mutant(**one["mutant"])}) for one in kept]


def main() -> int:
    """Judge the list, or lines drawn at random; 1 if a line of the list survives."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.mutants", description=__doc__)
    parser.add_argument("--random", type=int, default=0, help="so many lines drawn, not the list")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--room", choices=sorted(ROOMS), nargs="+", default=sorted(ROOMS))
    parser.add_argument("--wider", action="store_true", help="ask verification, stored numbers")
    parser.add_argument("--coverage", type=Path, metavar="FILE", help="ask all that execute it")
    parser.add_argument("--durations", type=Path, metavar="FILE", help="pytest --junitxml")
    parser.add_argument("--limit", type=float, default=120.0, help="time for one line [s]")
    parser.add_argument("-o", "--output", type=Path, help="verdicts as JSON")
    given = parser.parse_args()
    drawn = list(random_mutants(given.random, given.seed, given.room))
    chosen = drawn if given.random else list(MUTANTS)
    verdicts = read(given.output)

    def judge(judged_line: Callable[[Mutant], Verdict]) -> None:
        for mutant in chosen[len(verdicts) :]:
            verdict = judged_line(mutant)
            if given.wider and verdict.outcome == "survived":
                verdict = judged(replace(mutant, tests=WIDER))
            verdicts.append(verdict)
            if given.output:
                text = json.dumps([asdict(v) for v in verdicts], indent=1) + "\n"
                given.output.write_text(text, "utf-8")
            change = f"{mutant.before.strip()} -> {mutant.after.strip()}"
            line = f"{verdict.outcome:9}  {verdict.seconds:5.0f} s  {mutant.file}: {change}"
            print(f"{line}  {verdict.test}", flush=True)

    if given.coverage:
        with_warm_tests(
            lambda warm: judge(partial(quickly_judged, data=given.coverage, warm=warm)),
            given.limit,
            given.durations,
        )
    else:
        judge(judged)
    stored = sum("tests/regression" in verdict.test for verdict in verdicts)
    noticed = sum(verdict.outcome in NOTICED for verdict in verdicts)
    print(
        f"{noticed} of {len(verdicts)} spoiled lines were noticed, {stored} by stored numbers alone"
    )
    return int(noticed < len(verdicts) and not given.random)


if __name__ == "__main__":
    sys.exit(main())
