"""Curves from text files of points: columns x, y (and z), one block of lines per curve."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array

_COMMENT = ("#", "%", "//", "!")
# column separator and decimal mark, in order of preference
_STYLES = ((r"\s*;\s*", ","), (r"\s*;\s*", "."), (r"\s*,\s*", "."), (r"\s+", "."), (r"\s+", ","))


def read_point_file(path: Path, unit: float) -> list[Array]:
    """Read curves from columns of numbers.

    Parameters
    ----------
    path : Path
        Text in UTF-8 or Latin-1: two columns x, y or three columns x, y, z, separated by comma,
        semicolon, tab or blanks, decimal point or comma; header lines before the first number;
        an empty line begins a new curve.
    unit : float
        Length of one unit of the file. [m]

    Returns
    -------
    list of ndarray
        Curves in the order of the file, shape (n, 2). [m]

    Raises
    ------
    GeometryError
        For binary files, other encodings, lines that are not numbers and values that are not
        finite.
    """
    lines = _decoded(path).splitlines()
    # the style in which most lines are numbers
    sample = [line.strip() for line in lines if line.strip()]
    counts = [sum(_numbers(line, *style) is not None for line in sample) for style in _STYLES]
    best = int(np.argmax(counts))
    if counts[best] == 0:
        raise GeometryError(path, "no line with 2 or 3 numbers", "columns x, y or x, y, z")
    separator, mark = _STYLES[best]
    curves: list[list[list[float]]] = [[]]
    for number, line in enumerate(lines, start=1):
        text = line.strip()
        if text.startswith(_COMMENT):
            continue
        if not text:
            curves.append([])
            continue
        row = _numbers(text, separator, mark)
        if row is None and any(curves):
            raise GeometryError(path, f"{text[:40]!r} in line {number}", "2 or 3 numbers")
        if row is not None:
            curves[-1].append(row[:2])
    return [_finite(path, np.asarray(curve) * unit) for curve in curves if curve]


def _decoded(path: Path) -> str:
    raw = path.read_bytes()
    if raw.startswith((b"\xff\xfe", b"\xfe\xff")):
        raise GeometryError(path, "text in UTF-16", "UTF-8 or Latin-1")
    control = sum(byte < 9 or 13 < byte < 32 for byte in raw[:4096])
    if control:
        raise GeometryError(path, "a binary file", "text with columns of numbers")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("latin-1")


def _numbers(text: str, separator: str, mark: str) -> list[float] | None:
    words = [word for word in re.split(separator, text) if word]
    if mark == ",":
        words = [word.replace(",", ".") for word in words]
    if len(words) not in (2, 3):
        return None
    try:
        return [float(word) for word in words]
    except ValueError:
        return None


def _finite(path: Path, curve: Array) -> Array:
    if not np.all(np.isfinite(curve)):
        row = int(np.argmin(np.all(np.isfinite(curve), axis=1))) + 1
        raise GeometryError(path, f"a value that is not finite in point {row}", "finite numbers")
    return curve
