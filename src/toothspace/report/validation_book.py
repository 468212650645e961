"""Validation book: every published number, claim and figure with ours over it and a verdict."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

import toothspace
from toothspace.core.files import write_text
from toothspace.plotting.film_maps import HEIGHT, point_maps
from toothspace.plotting.style import BLUE, ORANGE, figure_to_svg, new_figure, styled
from toothspace.report.page import render
from toothspace.validation.claim import ComparedCurve, ComparedValue, Examined

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_FEW = 12
"""Points up to which each is marked."""
_VERDICTS = ("pass", "fail", "cannot be had")


@styled
def claim_figure(curves: Sequence[ComparedCurve]) -> Figure:
    """Curves of one claim side by side, ours as a line over the published points.

    Parameters
    ----------
    curves : sequence of ComparedCurve
        At least one.
    """
    figure = new_figure(3.6 * max(len(curves), 2), 2.9)
    for axes, curve in zip(figure.subplots(1, len(curves), squeeze=False)[0], curves, strict=True):
        marker = "." if curve.x.size <= _FEW else None
        axes.plot(curve.x, curve.y, color=BLUE, marker=marker, label="toothspace")
        if curve.published is not None:
            look = {"color": ORANGE, "markersize": 3.5, "label": "published"}
            axes.plot(curve.places, curve.published, "o", **look)
            axes.legend()
        if curve.logarithmic:
            axes.set_xscale("log")
            axes.set_yscale("log")
        axes.set(title=curve.name, xlabel=curve.x_label, ylabel=curve.y_label)
    return figure


def write_book(examined: Sequence[Examined], path: Path) -> Path:
    """Write the validation book as one HTML page that opens offline.

    Parameters
    ----------
    examined : sequence of Examined
        Claims with what was found, those of one source together.
    """
    page = render(
        "validation.html.j2",
        chapters=[
            {"source": source, "claims": [_shown(one) for one in found]}
            for source, found in groupby(examined, key=lambda one: one.claim.source)
        ],
        counts=_counts(examined),
        version=toothspace.__version__,
    )
    return write_text(path, page)


def _shown(one: Examined) -> dict[str, Any]:
    curves, films = one.finding.curves, one.finding.films
    figures = [claim_figure(curves)] if curves else []
    figures += [] if films is None else [point_maps(films, HEIGHT)]
    return {
        "claim": one.claim,
        "verdict": one.verdict,
        "trouble": one.trouble,
        "duration": one.duration,
        "rows": [_row(value) for value in one.finding.values]
        + [
            {
                "name": f"largest distance from the published points: {c.name}",
                "published": "0",
                "ours": f"{c.error:.4g}",
                "unit": c.y_label,
                "deviation": "",
                "allowed": "" if math.isinf(c.tolerance) else _range(0.0, c.tolerance),
                "verdict": c.verdict,
            }
            for c in curves
            if c.published is not None
        ],
        "figures": [figure_to_svg(figure) for figure in figures],
    }


def _row(value: ComparedValue) -> dict[str, str]:
    published = f"{value.published:.4g}" if value.published is not None else value.words
    deviation = "" if math.isnan(value.deviation) else f"{100.0 * value.deviation:+.2f} %"
    return {
        "name": value.name,
        "published": published,
        "ours": f"{value.ours:.4g}",
        "unit": value.unit,
        "deviation": deviation,
        "allowed": _range(value.low, value.high),
        "verdict": value.verdict,
    }


def _range(low: float, high: float) -> str:
    if math.isinf(low) and math.isinf(high):
        return ""
    if math.isinf(high):
        return f"at least {low:.4g}"
    if math.isinf(low):
        return f"up to {high:.4g}"
    return f"{low:.4g} to {high:.4g}"


def _counts(examined: Sequence[Examined]) -> dict[str, int]:
    return {verdict: sum(one.verdict == verdict for one in examined) for verdict in _VERDICTS}


def summary_of(examined: Sequence[Examined]) -> dict[str, Any]:
    """Return what ``toothspace validate --json`` prints."""
    judged = [one for one in examined if one.claim.measure is not None]
    other = [one.claim.key for one in judged if (one.verdict == "pass") == bool(one.claim.reason)]
    trouble = any(one.trouble for one in examined)
    return {
        "claims": {
            one.claim.key: {
                "source": one.claim.source.key,
                "verdict": one.verdict,
                "values": [_row(value) for value in one.finding.values],
                "trouble": one.trouble,
            }
            for one in examined
        },
        "counts": _counts(examined),
        "failing": [one.claim.key for one in examined if one.verdict == "fail"],
        "unexpected": other,
        "status": "failed" if trouble or other else "done",
        "wall_time_s": sum(one.duration for one in examined),
    }
