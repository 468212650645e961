"""Damaged and senseless inputs: one clear line each, no hang, no crash, no memory without end.

``python -m tests.fuzz --count 20000`` draws so many inputs for every reader, each reader in a
process of its own that may take 2 GB; ``--only result`` chooses one. What fails is printed
in its smallest form, and kept by hypothesis for the next run.
"""

from __future__ import annotations

import argparse
import copy
import subprocess
import sys
import tempfile
import time
import tomllib
from collections import Counter
from collections.abc import Callable, Mapping
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st

from toothspace.case import Case, load_case
from toothspace.core.errors import ToothspaceError
from toothspace.core.files import load_arrays, save_arrays
from toothspace.core.signals import column_names, read_columns
from toothspace.core.units import parse_quantity
from toothspace.geometry.cad_export import export_gear
from toothspace.geometry.gear_finder import find_gears
from toothspace.geometry.involute import InvoluteGear, generate_profile
from toothspace.geometry.tooth_deviations import read_tooth_deviations
from toothspace.model.fluid import fit_table
from toothspace.results.solution import load_solution

CASES = Path(__file__).resolve().parent.parent / "cases"
LONGEST = 10.0
"""Time of the processor that one input may take. [s]"""
MEMORY = 2**31
"""Memory that a reader may take. [byte]"""
_LONGEST_LINE = 2000

Damage = list[tuple[float, int, bytes]]
"""Places in a text or file (0 to 1), how many bytes go there, and what comes instead."""

DAMAGE = st.lists(
    st.tuples(
        st.floats(0.0, 1.0, exclude_max=True),
        st.integers(0, 40),
        st.one_of(
            st.binary(max_size=8),
            st.sampled_from(
                [b"\x00", b"\xff\xff\xff\xff", b"=", b"[", b"[[", b'"', b"nan", b"-1", b"1e308"]
            ),
        ),
    ),
    min_size=1,
    max_size=6,
)
TEXT = st.text(max_size=60)
_NUMBERS = ["1", "9", ".", "e", "-", "nan", "inf", "_", "%", "\0"]
_UNITS = ["m", "km", "bar", "rad", "deg", "degC", "/", "*", "**", "^", "(", ")", "²", "·", " "]
TOKENS = st.lists(st.sampled_from([*_NUMBERS, *_UNITS]), max_size=200).map("".join)


def damaged(content: bytes, damage: Damage) -> bytes:
    """Content with parts cut out and others put in."""
    found = bytearray(content)
    for place, cut, put in damage:
        at = int(place * len(found))
        found[at : at + cut] = put
    return bytes(found)


VERDICTS: Counter[str] = Counter()
"""How many inputs were read, and how many refused, since it was cleared."""


def check(read: Callable[[], Any]) -> None:
    """Assert that an input is read in time, or refused in a line per fault with what was found.

    Any other exception, as a traceback would show it to a user, passes through.
    """
    started, lines = time.process_time(), list[str]()
    try:
        read()
    except ToothspaceError as error:
        lines = str(error).split("\n")
    for line in lines:
        assert "found" in line or "not a result" in line, lines
        assert len(line) < _LONGEST_LINE, f"{len(line)} characters: {line[:200]}"
    VERDICTS["refused" if lines else "read"] += 1
    assert time.process_time() - started < LONGEST, "took too long"


@cache
def case_texts() -> tuple[bytes, ...]:
    return tuple(path.read_bytes() for path in sorted(CASES.glob("*.toml")))


@cache
def folder() -> Path:
    return Path(tempfile.mkdtemp(prefix="fuzz"))


def file_of(content: bytes, name: str) -> Path:
    path = folder() / name
    path.write_bytes(content)
    return path


@cache
def result_bytes() -> bytes:
    """A small result, without the checksum that would refuse all damage at once."""
    from tests.fake_solution import fake_solution

    data = fake_solution().data.isel(shaft_angle=slice(0, 5))
    path = folder() / "whole.nc"
    small = fake_solution().__class__(**{**fake_solution().__dict__, "data": data})
    small.save(path)
    return path.read_bytes().partition(b"\ntoothspace BLAKE2b")[0]


@cache
def cache_bytes() -> bytes:
    path = folder() / "whole.npz"
    save_arrays(path, {"depth": np.arange(20.0), "size": np.asarray(3)})
    return path.read_bytes()


CSV = (
    b"time [s],shaft_speed [rpm],pressure_difference [bar]\n" + b"0,100,2.5\n0.1,110,2.6\n" * 5,
    b"temperature [degC];pressure [bar]\n20;1\n20;100\n",
    b"temperature [degC],pressure [bar],density [kg/m3],dynamic_viscosity [mPa s]\n"
    + b"20,1,860,40\n20,100,865,45\n20,200,870,50\n60,1,840,15\n60,100,846,17\n60,200,851,19\n",
)


def read_case(data: st.DataObject) -> None:
    content = damaged(data.draw(st.sampled_from(case_texts())), data.draw(DAMAGE))
    check(lambda: Case.from_toml(content.decode("utf-8", "replace"), CASES, "case").check())


def read_override(data: st.DataObject) -> None:
    tables = tomllib.loads(data.draw(st.sampled_from(case_texts())).decode())
    names = [f"{a}.{b}" for a, inner in tables.items() if isinstance(inner, dict) for b in inner]
    key = data.draw(st.sampled_from(names) | TEXT)
    value = data.draw(TEXT | TOKENS | st.integers().map(str))

    check(lambda: load_case(copy.deepcopy(tables), [f"{key}={value}"]).check())


def read_unit(data: st.DataObject) -> None:
    text, unit = data.draw(TEXT | TOKENS), data.draw(st.sampled_from(["mm", "bar", "rpm", "degC"]))
    check(lambda: parse_quantity(text, unit))


def read_result(data: st.DataObject) -> None:
    path = file_of(damaged(result_bytes(), data.draw(DAMAGE)), "damaged.nc")
    check(lambda: load_solution(path).summary() and None)


def read_store(data: st.DataObject) -> None:
    path = file_of(damaged(cache_bytes(), data.draw(DAMAGE)), "damaged.npz")
    check(lambda: load_arrays(path))


@cache
def outlines() -> Mapping[str, bytes]:
    """A gear as points, DXF and STL, small enough to be read a thousand times."""
    return {kind: drawing(kind) for kind in ("txt", "dxf", "stl")}


@cache
def drawing(kind: str) -> bytes:
    gear = InvoluteGear(8, 2.75e-3, np.deg2rad(20.0), 0.4, 30e-3)
    path = folder() / f"whole.{kind}"
    export_gear(generate_profile(gear, 60), path, 8e-3)
    return path.read_bytes()


@cache
def teeth() -> Mapping[str, bytes]:
    """Deviations of teeth as a table and as the curve file of a gear tester."""
    from tests.unit.machines.test_measured_teeth import curve_file, known, table_file

    writers = {"csv": table_file, "mka": curve_file}
    paths = {kind: folder() / f"whole.{kind}" for kind in writers}
    return {k: write(paths[k], *known()).read_bytes() for k, write in writers.items()}


def read_outline(data: st.DataObject) -> None:
    kind = data.draw(st.sampled_from([*outlines()]))
    path = file_of(damaged(outlines()[kind], data.draw(DAMAGE)), f"damaged.{kind}")
    check(lambda: find_gears(path, 1e-3))


def read_solid(data: st.DataObject) -> None:
    path = file_of(damaged(drawing("step"), data.draw(DAMAGE)), "damaged.step")
    check(lambda: find_gears(path, 1e-3))


def read_teeth(data: st.DataObject) -> None:
    from tests.unit.machines.test_measured_teeth import FLANK

    kind = data.draw(st.sampled_from([*teeth()]))
    path = file_of(damaged(teeth()[kind], data.draw(DAMAGE)), f"teeth.{kind}")
    check(lambda: read_tooth_deviations(path, FLANK, 12))


def read_measured(data: st.DataObject) -> None:
    path = file_of(damaged(data.draw(st.sampled_from(CSV)), data.draw(DAMAGE)), "damaged.csv")
    check(lambda: column_names(path))
    check(lambda: read_columns(path, {"time": "s", "shaft_speed": "rpm"}))
    check(lambda: fit_table(path, 313.15))


READERS: Mapping[str, Callable[[st.DataObject], None]] = {
    "case": read_case,
    "override": read_override,
    "unit": read_unit,
    "result": read_result,
    "store": read_store,
    "measured": read_measured,
    "outline": read_outline,
    "teeth": read_teeth,
    "solid": read_solid,
}
"""What reads inputs from outside, by name."""


def fuzz(name: str, count: int) -> None:
    """Draw so many inputs for a reader; raises with the smallest that :func:`check` finds bad."""
    VERDICTS.clear()

    @settings(
        max_examples=count,
        deadline=None,
        suppress_health_check=list(HealthCheck),
        phases=[Phase.reuse, Phase.generate, Phase.shrink],
    )
    @given(st.data())
    def run(data: st.DataObject) -> None:
        READERS[name](data)

    run()


def main() -> int:
    parser = argparse.ArgumentParser("python -m tests.fuzz", description=__doc__)
    parser.add_argument("--count", type=int, default=2000)
    parser.add_argument("--only", choices=[*READERS])
    parser.add_argument("--here", action="store_true", help="in this process")
    given_options = parser.parse_args()
    if given_options.here:
        import resource

        resource.setrlimit(resource.RLIMIT_DATA, (MEMORY, MEMORY))
        fuzz(given_options.only, given_options.count)
        return 0
    failed = []
    for name in [given_options.only] if given_options.only else READERS:
        command = [sys.executable, "-m", "tests.fuzz", "--here", "--only", name]
        started = time.perf_counter()
        done = subprocess.run([*command, "--count", str(given_options.count)], check=False)
        seconds = time.perf_counter() - started
        verdict = "fine" if done.returncode == 0 else f"FAILED with code {done.returncode}"
        counted = f"{given_options.count} inputs in {seconds:.0f} s"
        sys.stdout.write(f"{name:<10} {counted}: {verdict}\n")
        failed += [name] * (done.returncode != 0)
    return len(failed)


if __name__ == "__main__":
    sys.exit(main())
