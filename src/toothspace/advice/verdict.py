"""Sentences that say what the numbers mean."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from toothspace.results.ledger import LossCause, loss_causes
from toothspace.results.solution import Solution


def verdict(solution: Solution) -> str:
    """Return one or two sentences on what the machine does and where power is lost."""
    numbers = solution.summary()
    if "time" in solution.data.sizes:
        return _course(numbers)
    mode = solution.data.attrs.get("mode", "machine")
    flow, torque = _number(numbers, "mean_flow_L_per_min"), _number(numbers, "mean_torque_N_m")
    overall = _number(numbers, "overall_efficiency")
    speed = _number(numbers, "shaft_speed_rpm")
    if mode == "motor":
        work = f"turns {flow:.2f} L/min into {torque:.2f} N m"
    else:
        work = f"delivers {flow:.2f} L/min for {torque:.2f} N m"
    low, high = (_number(numbers, f"{port}_pressure_bar") for port in ("inlet", "outlet"))
    text = f"At {speed:.0f} rpm, from {low:.3g} to {high:.3g} bar, the {mode} {work}."
    if math.isfinite(overall):
        parts = ("volumetric", "hydromechanical")
        shares = [f"{p} {100.0 * _number(numbers, f'{p}_efficiency'):.1f} %" for p in parts]
        text += f" Overall efficiency is {100.0 * overall:.1f} % ({', '.join(shares)});"
        text += f" {_lost(loss_causes(solution.ledger))}."
    return text


def _course(numbers: Mapping[str, float | str]) -> str:
    """What happened in a run over time."""
    duration, speed = _number(numbers, "duration_s"), _number(numbers, "max_shaft_speed_rpm")
    start, ratio = _number(numbers, "startup_pressure_bar"), numbers["startup_pressure_ratio"]
    text = f"{duration:.4g} s with at most {speed:.0f} rpm."
    if math.isfinite(start):
        time = _number(numbers, "breakaway_time_s")
        text += f" The shaft breaks away after {time:.3g} s; starting takes {start:.3g} bar"
        running = _number(numbers, "max_running_pressure_bar")
        if math.isfinite(running):
            text += f", {ratio:.3g} times the {running:.3g} bar of running"
        text += "."
    return text


def _lost(losses: Sequence[LossCause]) -> str:
    """Points of efficiency that each cause takes, largest first, and the largest loss."""
    shares: dict[str, float] = {}
    for entry in losses:
        shares[entry.cause] = shares.get(entry.cause, 0.0) + 100.0 * entry.share
    named = sorted(shares.items(), key=lambda item: -item[1])
    parts = [f"{cause} {share:.1f}" for cause, share in named if share >= 0.05]
    text = f"points of efficiency lost: {', '.join(parts)}" if parts else "no losses"
    total = sum(entry.power for entry in losses)
    if total <= 0.0:
        return text
    largest = max(losses, key=lambda entry: entry.power)
    where = f"{largest.cause}, {largest.label}, with {largest.power:.0f} W"
    return f"{text}; the largest loss is {where}, {100.0 * largest.power / total:.0f} % of all"


def _number(numbers: Mapping[str, float | str], name: str) -> float:
    value = numbers.get(name, math.nan)
    return float(value) if not isinstance(value, str) else math.nan
