"""What is to be known of a result: limits, causes, and the verdict on it."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from toothspace.core.finding import DesignCheck, Finding
from toothspace.model.description import MachineDescription
from toothspace.results.credibility import WHOLE
from toothspace.results.ledger import loss_causes
from toothspace.results.ripple import extremes
from toothspace.results.solution import Solution

_BAR, _MPA = 1e5, 1e6
_PEAK = 1.5
_FULL_FILM = 3.0
_BUSH_PRESSURE, _BUSH_SPEED, _BUSH_PV = 140.0, 5.0, 10.0
_FLANK_PRESSURE = 1500.0
_OIL_TEMPERATURE = 80.0

CAVITATION = "Cavitation damage index: power of collapsing vapour"
"""Label of the limit that judges cavitation."""

_ENCLOSED = "Look where fluid is enclosed: relief grooves, backlash and the timing of the ports."
_COOLER = "Cool the oil, or lower pressure and speed."
_FILLED = "Lower the speed, raise the inlet pressure or widen the inlet."
_FLOATED = "Take a thicker oil, a longer bearing or smoother surfaces, or lower the load."
_BUSHED = "Take a larger bearing or one for boundary lubrication, or bring its film up."
_FLANKED = (
    "Lower the pressure, or take flanks of larger radius: more teeth or a larger pressure angle. "
    "Width and module carry as much more load as they bring."
)

_BUSH = "metal-polymer bushes in oil, GGB data sheets DU, DP4-B; judged where films are not full"
_ORDER = ("serious", "caution", "note")


class JudgedLimit(NamedTuple):
    """A quantity of a run against its limit."""

    label: str
    """Quantity and where."""
    value: str
    """Found, with unit."""
    allowed: str
    """Limit, with unit."""
    verdict: str
    """``met``, ``exceeded`` or ``not judged``."""
    source: str
    """Where the limit comes from."""
    advice: str = ""
    """What to do where it is exceeded."""
    excess: float = 1.0
    """Part of the limit by which it is missed; of cavitation its share of all losses; 1 where
    neither is known. [-]
    """

    @property
    def exceeded(self) -> bool:
        """Whether the limit was judged and is not met."""
        return self.verdict == "exceeded"


def limits_of(solution: Solution, description: MachineDescription | None) -> list[JudgedLimit]:
    """Return the limits of a steady result: pressure, filling, films, contact, cavitation."""
    if "shaft_angle" not in solution.data.sizes or "chamber_pressure" not in solution.data:
        return []
    summary = solution.summary()
    power = float(summary["cavitation_index_W"])
    share = power / max(abs(float(summary["hydraulic_power_W"])), 1e-12)
    losses = sum(loss.power for loss in loss_causes(solution.ledger))
    data = solution.data
    high = max(float(data[f"{port}_pressure"].mean()) for port in ("inlet", "outlet"))
    peak = float(extremes(data, "chamber_pressure")[1].max())
    # oil in the drain, an upper bound without a heat network, and with one in the films
    oil, temperatures = "oil and seals of makers' data sheets", list[JudgedLimit]()
    drain = float(summary["drain_temperature_degC"])
    if solution.status in WHOLE and np.isfinite(drain):
        bound = "" if "temperature" in data else "; an upper bound, no heat to the housing"
        temperatures.append(
            _judged("Drain temperature", drain, _OIL_TEMPERATURE, "°C", oil + bound, _COOLER)
        )
    film = summary.get("highest_film_temperature_degC")
    if solution.status in WHOLE and film:
        oil += ", for the oil at the ports; films may be warmer"
        one = _judged("Highest film temperature", float(film), _OIL_TEMPERATURE, "°C", oil, _COOLER)
        temperatures.append(one if one.verdict == "met" else one._replace(verdict="not judged"))
    source = "a working pressure and a half, usual peak in pressure limits of makers"
    found = [
        _judged(
            "Highest chamber pressure", peak / _BAR, _PEAK * high / _BAR, "bar", source, _ENCLOSED
        ),
        *temperatures,
        JudgedLimit(
            CAVITATION,
            f"{power:.4g} W, {100.0 * share:.2g} % of the hydraulic power",
            "no vapour",
            "met" if power == 0.0 else "exceeded",
            "potential energy of cavities, Fortes-Patella, Reboud, Briancon-Marjollet (2004)",
            _FILLED,
            power / losses if losses > 0.0 else 1.0,
        ),
    ]
    if description is None:
        return found
    found += [*_filling(solution, description), *_bearings(solution, description)]
    if "contact_force" in solution.data:
        found += _contacts(solution, description)
    return found


def _judged(
    label: str, value: float, limit: float, unit: str, source: str, advice: str
) -> JudgedLimit:
    verdict = "met" if value <= limit else "exceeded"
    found, allowed = f"{value:.4g} {unit}", f"up to {limit:.4g} {unit}"
    excess = value / limit - 1.0 if limit > 0.0 else 1.0
    return JudgedLimit(label, found, allowed, verdict, source, advice, excess)


def _filling(solution: Solution, description: MachineDescription) -> Iterator[JudgedLimit]:
    """Speed of the tips, which the inlet pressure must be able to give the fluid."""
    data = solution.data
    farthest = [
        abs(body.speed_ratio) * float(np.max(np.hypot(*description.outlines[body.name].T)))
        for body in description.bodies
        if body.name in description.outlines
    ]
    if not farthest:
        return
    low = min(float(data[f"{port}_pressure"].mean()) for port in ("inlet", "outlet"))
    highest = float(np.sqrt(2.0 * low / float(data["inlet_density"])))
    speed = max(farthest) * float(np.abs(data["shaft_speed"]).max())
    source = "filling: speed that the inlet pressure gives the fluid, Bernoulli"
    yield _judged("Speed of the tips", speed, highest, "m/s", source, _FILLED)


def _bearings(solution: Solution, description: MachineDescription) -> Iterator[JudgedLimit]:
    data = solution.data
    names = [str(name) for name in data["journal"].values] if "journal" in data.dims else []
    speeds = {body.name: abs(body.speed_ratio) for body in description.bodies}
    for journal in (j for j in description.journals if j.body in names):
        where = journal.body.replace("_", " ")
        lowest = extremes(data, "journal_film_height")[0]
        height = float(lowest[names.index(journal.body)])
        ratio = height / journal.roughness
        full = ratio >= _FULL_FILM
        yield JudgedLimit(
            f"Film over roughness, bearing of {where}",
            f"{ratio:.3g} ({1e6 * height:.2f} µm)",
            f"at least {_FULL_FILM:.3g}",
            "met" if full else "exceeded",
            "full film, Hamrock, Schmid, Jacobson (2004)",
            _FLOATED,
            _FULL_FILM / max(ratio, 1e-12) - 1.0,
        )
        force = np.linalg.norm(np.asarray(data["journal_force"].sel(body=journal.body)), axis=1)
        load = float(np.mean(force)) / (journal.count * journal.diameter * journal.length) / _MPA
        speed = 0.5 * journal.diameter * speeds[journal.body] * float(data["shaft_speed"].mean())
        for label, value, limit, unit in (
            ("p", load, _BUSH_PRESSURE, "MPa"),
            ("v", speed, _BUSH_SPEED, "m/s"),
            ("p v", load * speed, _BUSH_PV, "MPa m/s"),
        ):
            entry = _judged(
                f"Bearing of {where}, {label} without a full film",
                value,
                limit,
                unit,
                _BUSH,
                _BUSHED,
            )
            yield entry._replace(verdict="not judged") if entry.exceeded and full else entry
    if names:
        yield JudgedLimit(
            "Bearing life",
            "no rolling bearing",
            "ISO 281",
            "not judged",
            "plain bearings have no rating life; p, v and p v above",
        )


def _contacts(solution: Solution, description: MachineDescription) -> Iterator[JudgedLimit]:
    """Largest Hertz pressure of every kind of contact."""
    data = solution.data
    shaft_angle = np.asarray(data["shaft_angle"])
    names = [str(name) for name in data["contact"].values]
    for pair in description.contacts:
        columns = [k for k, name in enumerate(names) if name.rsplit("_", 1)[0] == pair.name]
        if len(columns) != pair.count:
            continue
        force = np.maximum(np.asarray(data["contact_force"])[:, columns], 0.0)
        shape = pair.geometry(pair.phases + pair.angle_ratio * shaft_angle[:, None])
        # of a line contact, sqrt(w E' kappa / (2 pi))
        curvature = np.maximum(1.0 / shape[..., 2] + 1.0 / shape[..., 3], 0.0)
        load = force / pair.width
        pressure = np.sqrt(load * pair.effective_modulus * curvature / (2.0 * np.pi))
        if float(np.max(pressure)) > 0.0:
            label = f"Contact pressure, {pair.name.replace('_', ' ')}"
            source = "case-hardened steel, ISO 6336-5"
            yield _judged(
                label, float(np.max(pressure)) / _MPA, _FLANK_PRESSURE, "MPa", source, _FLANKED
            )


def findings_of(
    solution: Solution, description: MachineDescription | None, note: str = ""
) -> tuple[Finding, ...]:
    """List what a reader should know before trusting a result or building its machine.

    Serious ones first; among those, limits by how far they are missed, then rules, then what is
    slight; each sentence once.

    Parameters
    ----------
    solution : Solution
        Result, complete or not.
    description : MachineDescription, optional
        Its machine; without it rules, and limits of its bearings and teeth, are left out.
    note : str, optional
        Why there is no machine.
    """
    limits = [limit_finding(x) for x in limits_of(solution, description) if x.exceeded]
    limits.sort(key=lambda finding: -finding.weight)
    rules = () if description is None else description.checks
    # begins of cavitation, where no limit tells it by its power
    count = sum(event.kind == "cavitation_onset" for event in solution.events)
    if count == 0 or any(limit.quantity == CAVITATION for limit in limits):
        cavitation = []
    else:
        times = "once" if count == 1 else f"{count} times"
        cavitation = [
            Finding(
                "warning",
                f"Cavitation begins {times} in the evaluation window; see events.",
                quantity=CAVITATION,
                found=times,
                allowed="no vapour",
            )
        ]
    found = [
        *solution.warnings,
        *limits,
        *cavitation,
        *(rule_finding(check) for check in rules if not check.passed),
        *([Finding("warning", note, severity="note")] if note else ()),
    ]
    once = {finding.sentence: finding for finding in reversed(found)}
    return tuple(
        sorted(reversed(once.values()), key=lambda x: (_ORDER.index(x.severity), x.slight))
    )


def limit_finding(limit: JudgedLimit) -> Finding:
    """A limit that is exceeded as finding."""
    return Finding(
        "limit",
        f"{limit.label} is {limit.value}, allowed {limit.allowed} ({limit.source}).",
        quantity=limit.label,
        found=limit.value,
        allowed=limit.allowed,
        advice=limit.advice,
        weight=limit.excess,
    )


def rule_finding(check: DesignCheck) -> Finding:
    """A design rule that is not met as finding."""
    return Finding(
        "rule",
        f"{check.label} is {check.shown_value}, allowed {check.allowed}.",
        quantity=check.label,
        found=check.shown_value,
        allowed=check.allowed,
        advice=check.reason,
    )


def verdict(solution: Solution) -> str:
    """Return one or two sentences on what the machine does and where power is lost."""
    numbers = solution.summary()
    if "time" in solution.data.sizes:
        duration, highest = _number(numbers, "duration_s"), _number(numbers, "max_shaft_speed_rpm")
        start, ratio = _number(numbers, "startup_pressure_bar"), numbers["startup_pressure_ratio"]
        course = f"{duration:.4g} s with at most {highest:.0f} rpm."
        if math.isfinite(start):
            time = _number(numbers, "breakaway_time_s")
            course += f" The shaft breaks away after {time:.3g} s; starting takes {start:.3g} bar"
            running = _number(numbers, "max_running_pressure_bar")
            if math.isfinite(running):
                course += f", {ratio:.3g} times the {running:.3g} bar of running"
            course += "."
        return course
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
        losses = loss_causes(solution.ledger)
        lost: dict[str, float] = {}
        for entry in losses:
            lost[entry.cause] = lost.get(entry.cause, 0.0) + 100.0 * entry.share
        named = sorted(lost.items(), key=lambda item: -item[1])
        named_lost = [f"{cause} {share:.1f}" for cause, share in named if share >= 0.05]
        told = f"points of efficiency lost: {', '.join(named_lost)}" if named_lost else "no losses"
        total = sum(entry.power for entry in losses)
        if total <= 0.0:
            loss = told
        else:
            largest = max(losses, key=lambda entry: entry.power)
            where = f"{largest.cause}, {largest.label}, with {largest.power:.0f} W"
            loss = (
                f"{told}; the largest loss is {where}, {100.0 * largest.power / total:.0f} % of all"
            )
        text += f" {loss}."
    return text


def change_first(solution: Solution, findings: Sequence[Finding]) -> str:
    """Return in one or two sentences what to change first: what is wrong, else the largest loss.

    What is slight is named, but is nothing to change first.
    """
    judged = [finding for finding in findings if finding.severity != "note"]
    for finding in sorted(judged, key=lambda x: _ORDER.index(x.severity)):
        if not finding.slight:
            return finding.sentence
    told = "Nothing has to be changed: all limits and design rules are met."
    if judged:
        missed = "; ".join(f"{finding.quantity}, {finding.found}" for finding in judged)
        told = f"Nothing has to be changed first: what is beyond its limit is slight ({missed})."
    losses = sorted(loss_causes(solution.ledger), key=lambda loss: -loss.power)
    if not losses:
        return told if judged else "Nothing: all limits and design rules are met."
    worst = losses[0]
    return (
        f"{told} The largest loss is {worst.cause}, {worst.label}: {worst.power:.3g} W, "
        f"{100.0 * worst.share:.2g} % of the power supplied."
    )


def _number(numbers: Mapping[str, float | str], name: str) -> float:
    value = numbers.get(name, math.nan)
    return float(value) if not isinstance(value, str) else math.nan
