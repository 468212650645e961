"""What limits the machine at an operating point, with verdicts and the sources of the limits."""

from __future__ import annotations

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from toothspace.model.description import MachineDescription
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
_FLANKED = "Take wider gears or a larger module, or lower the load."

_BUSH = "metal-polymer bushes in oil, GGB data sheets DU, DP4-B; judged where films are not full"


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

    @property
    def exceeded(self) -> bool:
        """Whether the limit was judged and is not met."""
        return self.verdict == "exceeded"


def limits_of(solution: Solution, description: MachineDescription | None) -> list[JudgedLimit]:
    """Return the limits of a steady result: pressure, filling, films, contact, cavitation."""
    if "shaft_angle" not in solution.data.sizes or "chamber_pressure" not in solution.data:
        return []
    found = [*_pressures(solution), *_temperature(solution), _cavitation(solution)]
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
    return JudgedLimit(label, found, allowed, verdict, source, advice)


def _pressures(solution: Solution) -> Iterator[JudgedLimit]:
    data = solution.data
    high = max(float(data[f"{port}_pressure"].mean()) for port in ("inlet", "outlet"))
    peak = float(extremes(data, "chamber_pressure")[1].max())
    source = "a working pressure and a half, usual peak in pressure limits of makers"
    yield _judged(
        "Highest chamber pressure", peak / _BAR, _PEAK * high / _BAR, "bar", source, _ENCLOSED
    )


def _temperature(solution: Solution) -> Iterator[JudgedLimit]:
    """Oil in the drain, an upper bound without a heat network, and with one in the films."""
    summary, source = solution.summary(), "oil and seals of makers' data sheets"
    drain = float(summary["drain_temperature_degC"])
    if np.isfinite(drain):
        bound = "" if "temperature" in solution.data else "; an upper bound, no heat to the housing"
        yield _judged("Drain temperature", drain, _OIL_TEMPERATURE, "°C", source + bound, _COOLER)
    if film := summary.get("highest_film_temperature_degC"):
        source += ", for the oil at the ports; films may be warmer"
        entry = _judged(
            "Highest film temperature", float(film), _OIL_TEMPERATURE, "°C", source, _COOLER
        )
        yield entry if entry.verdict == "met" else entry._replace(verdict="not judged")


def _cavitation(solution: Solution) -> JudgedLimit:
    summary = solution.summary()
    power = float(summary["cavitation_index_W"])
    share = power / max(abs(float(summary["hydraulic_power_W"])), 1e-12)
    return JudgedLimit(
        CAVITATION,
        f"{power:.4g} W, {100.0 * share:.2g} % of the hydraulic power",
        "no vapour",
        "met" if power == 0.0 else "exceeded",
        "potential energy of cavities, Fortes-Patella, Reboud, Briancon-Marjollet (2004)",
        _FILLED,
    )


def _filling(solution: Solution, description: MachineDescription) -> Iterator[JudgedLimit]:
    """Speed at which the tips are as fast as the inlet pressure can accelerate the fluid."""
    data = solution.data
    names = [body.name for body in description.bodies if body.name in description.outlines]
    if not names:
        return
    radius = max(float(np.max(np.hypot(*description.outlines[name].T))) for name in names)
    low = min(float(data[f"{port}_pressure"].mean()) for port in ("inlet", "outlet"))
    highest = np.sqrt(2.0 * low / float(data["inlet_density"])) / radius * 30.0 / np.pi
    speed = float(np.abs(data["shaft_speed"]).max()) * 30.0 / np.pi
    source = "filling: tip speed from the inlet pressure, Bernoulli"
    yield _judged("Shaft speed", speed, float(highest), "rpm", source, _FILLED)


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
