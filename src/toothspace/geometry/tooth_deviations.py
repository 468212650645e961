"""Deviations of every tooth of a measured gear, and the files of gear testers that hold them."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.files import reading
from toothspace.core.signals import column_names, read_columns
from toothspace.core.types import Array
from toothspace.geometry.gear_profile import InvoluteFlank

_NODES = 61
_MM, _UM = 1e-3, 1e-6
_CURVE = re.compile(
    r"^(?:Profil:)?\s*Zahn-Nr\.:\s*(\d+)\s*(links|rechts)\s*/\s*(\d+)\s+Werte\s*/?\s*z=", re.I
)
_TITLE = re.compile(r"^\s*([A-Za-zäöüÄÖÜß]+):\s*$")
_PITCH = re.compile(r"^\s*(linke|rechte) Zahnflanke\s*$")
_NUMBER = re.compile(r"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
_SIDES = {"l": "left", "r": "right"}


@final
@dataclass(frozen=True)
class ToothDeviations:
    """How far the flanks of every tooth stand off the involute of the gear."""

    roll_length: Array
    """Places on the flank, rising. Shape (n,). [m]"""
    left: Array
    right: Array
    """Distance along the normal, pitch deviation included, positive for excess material; teeth
    counter-clockwise. Shape (tooth_count, n). [m]
    """
    tip: Array
    """Radius of every tip above that of the gear. Shape (tooth_count,). [m]"""


def even_nodes(flank: InvoluteFlank) -> Array:
    """Places at even steps of the roll length along an involute. [m]."""
    start, end = flank.roll_length(flank.form_radius), flank.roll_length(flank.tip_form_radius)
    return np.linspace(start, end, _NODES)


def read_tooth_deviations(path: Path, flank: InvoluteFlank, tooth_count: int) -> ToothDeviations:
    r"""Read the deviations of every tooth from the file of a gear tester.

    Deviations at even steps of the roll length.

    Raises GeometryError for files of another layout, and gears with another tooth count.

    Parameters
    ----------
    path : Path
        ``.csv``: columns ``tooth [1]``, ``roll_length [mm]``, ``left [um]``, ``right [um]``
        with pitch deviation included and, where it was measured, ``tip [um]``; teeth from 1 on,
        counter-clockwise. ``.mka``: curve file of a Klingelnberg gear tester, teeth clockwise.
    flank : InvoluteFlank
        Involute of the gear.

    Notes
    -----
    A curve file holds, for each measured tooth and flank, deviations in micrometres at even
    steps of the roll length between the diameters of the measuring range, and for every tooth the
    cumulative pitch deviation :math:`F_p`, an arc on the measuring circle in the sense of counting;
    along the normal it is :math:`\pm F_p \cos\alpha_M`. Teeth without a curve take the mean of the
    measured ones.
    """
    nodes = even_nodes(flank)
    with reading(path, "a tester's file"):
        if path.suffix.lower() == ".mka":
            return _from_curve_file(path, flank, tooth_count, nodes)
        columns = {"tooth": "1", "roll_length": "mm", "left": "um", "right": "um"}
        with_tip = "tip" in column_names(path)
        data = read_columns(path, columns | ({"tip": "um"} if with_tip else {}))
        present = np.unique(data["tooth"])
        if not np.array_equal(present, np.arange(1, tooth_count + 1)):
            some = ", ".join(f"{value:g}" for value in present[:12]) or "none"
            raise GeometryError(path, f"teeth {some}", f"each of 1 to {tooth_count}")
        rows = [np.flatnonzero(data["tooth"] == number) for number in present]
        ordered = [row[np.argsort(data["roll_length"][row])] for row in rows]
        left, right = (
            np.array(
                [np.interp(nodes, data["roll_length"][row], data[side][row]) for row in ordered]
            )
            for side in ("left", "right")
        )
        tips = [float(data["tip"][row].mean()) if with_tip else 0.0 for row in ordered]
        return ToothDeviations(nodes, left, right, np.array(tips))


def _from_curve_file(
    path: Path, flank: InvoluteFlank, tooth_count: int, nodes: Array
) -> ToothDeviations:
    raw = path.read_bytes()
    lines = raw.decode("utf-8-sig" if raw.startswith(b"\xef\xbb\xbf") else "latin-1").splitlines()
    counted = _header(lines, r"Z.{1,2}hnezahl", path)[0]
    if counted != tooth_count:
        raise GeometryError(path, f"{counted:g} teeth", tooth_count)
    low = _header(lines, r"Start\b.*Messbereich", path)[0] * _MM
    high = _header(lines, r"Ende\b.*Messbereich", path)[0] * _MM
    start, end = sorted(flank.roll_length(0.5 * diameter) for diameter in (low, high))
    undefined = _header(lines, r"^UNDEFINED", path, missing=-2147483.648)[0]
    curves: dict[tuple[int, str], Array] = {}
    block, at = "", 0
    while at < len(lines):
        line = lines[at].strip()
        at += 1
        name, head = _TITLE.match(line), _CURVE.match(line)
        if name:
            block = name.group(1)
        if head is None or not (line.startswith("Profil:") or block == "Profil"):
            continue
        values: list[float] = []
        while at < len(lines) and len(values) < int(head.group(3)):
            values += [float(token) for token in lines[at].split()]
            at += 1
        curve = np.array(values)
        known = curve > undefined + 1.0
        if known.any():
            places = np.arange(len(curve))
            key = int(head.group(1)), _SIDES[head.group(2)[0].lower()]
            curves[key] = np.interp(places, places[known], curve[known])
    pitches: dict[str, dict[int, float]] = {}
    side = ""
    for line in lines:
        title, cells = _PITCH.match(line), line.split()
        if title:
            side = _SIDES[title.group(1)[0].lower()]
        elif side and len(cells) == 4 and cells[0].isdigit():
            pitches.setdefault(side, {})[int(cells[0])] = float(cells[2])
        elif side and cells and cells[0] != "Zahn-Nr.":
            side = ""
    circle = np.cos(flank.pressure_angle(0.25 * (low + high)))
    found = {}
    for side, sign in (("left", -1.0), ("right", 1.0)):
        own = {
            number: np.interp(nodes, np.linspace(start, end, len(values)), values * _UM)
            for (number, of), values in curves.items()
            if of == side
        }
        if not own:
            raise GeometryError(path, f"no profile of the {side} flank", "at least one")
        mean = np.mean(list(own.values()), axis=0)
        pitch = pitches.get(side, {})
        # an index deviation in the sense of counting, clockwise, is material on the right flank
        found[side] = np.array(
            [
                own.get(number, mean) + sign * circle * pitch.get(number, 0.0) * _UM
                for number in range(1, tooth_count + 1)
            ]
        )
    clockwise = -np.arange(tooth_count) % tooth_count
    return ToothDeviations(
        nodes, found["left"][clockwise], found["right"][clockwise], np.zeros(tooth_count)
    )


def _header(
    lines: Sequence[str], label: str, path: Path, missing: float | None = None
) -> list[float]:
    for line in lines:
        if re.search(label, line, re.IGNORECASE):
            text = line.split("!")[0].split(":")[-1] if ":" in line else line.split("!")[0]
            numbers = [float(token) for token in _NUMBER.findall(text)]
            if numbers:
                return numbers
    if missing is not None:
        return [missing]
    raise GeometryError(path, f"no line {label!r} with a number", "a curve file")
