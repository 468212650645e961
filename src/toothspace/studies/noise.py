"""Noise of a machine and of other designs of it: from forces on the casing to sound power."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.case import Case
from toothspace.closures.sound import (
    BAND_NUMBERS,
    a_weighting,
    sound_power_level,
    third_octave_sums,
)
from toothspace.core.errors import CaseError
from toothspace.core.frozen import FrozenDict
from toothspace.core.keys import Free, KeyTable, Named, declare, number, quantity, table, text
from toothspace.core.types import Array, ComplexArray
from toothspace.plotting.style import CYCLE, StudyFigure, new_figure, styled
from toothspace.results.noise import (
    HIGHEST_FREQUENCY,
    RADIATORS,
    Casing,
    CasingForces,
    Plate,
    blocked_foot_forces,
    casing_forces,
    orders_up_to,
    sound_powers,
)
from toothspace.results.ripple import harmonics, wave, working_side
from toothspace.studies.points import collected, operating_point_of, point, status_of
from toothspace.studies.study import Record, Study, StudyContext, StudyResult, StudyTable
from toothspace.studies.variation import unit_samples

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_BAR = 1e5
_DRAWS, _SEED = 128, 0
"""Draws of the free parameters for their joint effect."""
_FREE = {
    "casing": ("mass", "surface", "stiffness", "loss_factor"),
    "plate": (
        "length", "width", "thickness", "loss_factor",
        "foot_distance", "shaft_height", "mount_stiffness",
    ),
}  # fmt: skip
"""What varies, because nobody knows it better than by a factor."""
_AT_ONE_METRE = 10.0 * math.log10(2.0 * math.pi)
"""Sound power level less the mean level on a hemisphere of 1 m. [dB]"""
_GRID, _PER_WAVE = 720, 2.4
"""Samples are a multiple of the first; of the shortest wave so many. [-]"""
_FORCES = ("inside", "pressure", "net")
_ALL = "total"


@final
@dataclass(frozen=True, kw_only=True)
class NoiseStudy(KeyTable):
    """``kind = "noise"``: sound power of the case, and of designs that differ from it."""

    name: str = text("Name of the case itself among the designs.", default="case")
    designs: Mapping[str, Any] = declare(
        Named(item=Named(item=Free()), doc="Other designs by name: key paths with their values."),
        FrozenDict(),
    )
    reference: str | None = text(
        "Design to which differences refer; none: the case itself.", default=None
    )
    casing: Casing = table(Casing, "Casing, the same for all designs.")
    plate: Plate | None = table(
        Plate, "Plate under its feet; none: the casing hangs freely.", default=None
    )
    port_diameter: float | None = quantity(
        "mm",
        "Of both ports where hoses end, which carry no force; none: pipes carry it.",
        above=0,
        high=500,
        default=None,
    )
    spread: float = number(
        "Factor by which each free parameter of casing and plate may be wrong.",
        above=1,
        high=10,
        default=2.0,
    )

    def __post_init__(self) -> None:
        if self.name in self.designs:
            raise CaseError("name", f"{self.name!r}, as of a design", "a name of its own")
        if self.reference not in (None, self.name, *self.designs):
            allowed = ", ".join((self.name, *self.designs))
            raise CaseError("reference", f"{self.reference!r}", allowed)


def run(case: Case, context: StudyContext) -> StudyResult:
    """Run the case and its other designs, and find the sound power of each.

    Parameters
    ----------
    case : Case
        Steady case with moving bodies and ``kind = "noise"``.

    Returns
    -------
    StudyResult
        Over ``design``, the reference first: A-weighted sound power and the difference to it, with
        the range that the free parameters leave; over ``band`` third octaves; over ``order``
        forces on the casing.

    Raises
    ------
    CaseError
        If the case has no operating point or a preset without forces, or the reference cannot be
        run.
    """
    study = case.study
    assert isinstance(study, NoiseStudy)
    speed = operating_point_of(case).shaft_speed
    if not case.run.preset.has_losses:
        allowed = "a preset with forces on the bodies"
        raise CaseError("run.fidelity", f"{case.run.fidelity!r}", allowed).in_file(case.label)
    # multiples of most tooth counts, so that what is above folds back onto harmonics of the teeth
    samples = _GRID * math.ceil(_PER_WAVE * orders_up_to(HIGHEST_FREQUENCY, speed).size / _GRID)
    finest = {"run.samples_per_revolution": max(samples, case.run.samples_per_revolution)}
    names = (study.name, *study.designs)
    changes: list[Mapping[str, Any]] = [{}, *study.designs.values()]
    points = [point(case, {**finest, **change}) for change in changes]
    records = collected(points, context, NoiseSource(study.port_diameter or 0.0))
    good = [(n, r) for n, r in zip(names, records, strict=True) if "order" in r.numbers]
    first = study.reference or study.name
    if first not in dict(good):
        message = records[names.index(first)].message or "no result"
        raise CaseError(f"{case.label}: study.reference: {first!r} could not be run: {message}")
    good.sort(key=lambda item: item[0] != first)
    data = _dataset(study, [n for n, _ in good], [r for _, r in good])
    numbers = {
        "design": [name for name, _ in good],
        **{
            str(name): np.asarray(data[name]).tolist()
            for name in data
            if data[name].dims == ("design",) and data[name].dtype.kind == "f"
        },
        "points_failed": len(records) - len(good),
        "point_status": [r.status for r in records],
    }
    bands = np.asarray(data["band"])
    levels = np.asarray(data["sound_power_level"].sel(radiator=_ALL))
    totals = [name for name in numbers if name.endswith(("_dBA", "_dB", "_bar"))]
    free = np.asarray(data["free_parameter"])
    return StudyResult(
        status=status_of(records),
        data=data,
        numbers=numbers,
        tables=(
            StudyTable.of("noise", {name: numbers[name] for name in ("design", *totals)}),
            StudyTable.of(
                "third_octaves",
                {
                    "band (Hz)": bands.tolist(),
                    **{f"{n} (dB)": row.tolist() for (n, _), row in zip(good, levels, strict=True)},
                },
            ),
            StudyTable.of(
                "free_parameters",
                {
                    "parameter": free.tolist(),
                    "change": np.asarray(data["factor"]).tolist(),
                    **{
                        f"{what} {n} ({unit})": np.asarray(data[name][:, k]).tolist()
                        for k, (n, _) in enumerate(good)
                        for what, name, unit in (
                            ("level", "free_level", "dB(A)"),
                            ("difference", "free_difference", "dB"),
                        )
                    },
                },
            ),
        ),
    )


@final
@dataclass(frozen=True)
class NoiseSource:
    """Runs a case; forces on its casing and its pressure ripple in orders of the shaft."""

    port_diameter: float

    @property
    def label(self) -> str:
        """What is evaluated."""
        return f"noise source {self.port_diameter:.12g}"

    def __call__(self, case: Case) -> Mapping[str, Any]:
        """Real and imaginary parts beside the summary numbers."""
        from toothspace import api

        solution = api.simulate(case)
        data, machine = solution.data, api.describe(case)
        width = machine.geometry_summary.get("face_width_mm")
        forces = casing_forces(
            data,
            machine.bodies,
            1e-3 * width if isinstance(width, float) else math.inf,
            self.port_diameter,
        )
        side = working_side(data)
        ripple = harmonics(*wave(data, f"{side}_pressure"), forces.order)
        groups = {name: _parts(getattr(forces, name)) for name in _FORCES}
        return {
            **groups,
            "ripple": _parts({"ripple": ripple}),
            "order": forces.order.tolist(),
            "speed": forces.speed,
            **solution.summary(),
        }


def _parts(values: Mapping[str, ComplexArray]) -> dict[str, list[list[float]]]:
    return {name: [z.real.tolist(), z.imag.tolist()] for name, z in values.items()}


def _complex(parts: Mapping[str, Sequence[Sequence[float]]]) -> dict[str, ComplexArray]:
    return {name: np.array(z[0]) + 1j * np.array(z[1]) for name, z in parts.items()}


def _forces(record: Record) -> CasingForces:
    groups = {name: _complex(record.numbers[name]) for name in _FORCES}
    order = np.array(record.numbers["order"])
    return CasingForces(order=order, speed=float(record.numbers["speed"]), **groups)


@final
@dataclass(frozen=True)
class _Structure:
    casing: Casing
    plate: Plate | None

    def changed(self, factors: Mapping[str, float]) -> _Structure:
        """Return it with free parameters times factors."""
        parts: dict[str, Any] = {"casing": self.casing, "plate": self.plate}
        for path, factor in factors.items():
            part, _, name = path.partition(".")
            value = getattr(parts[part], name) * factor
            value = min(value, 1.0) if name == "loss_factor" else value
            parts[part] = replace(parts[part], **{name: value})
        return _Structure(**parts)

    @property
    def free(self) -> list[str]:
        """Paths of the free parameters that it has."""
        return [
            f"{part}.{name}"
            for part, names in _FREE.items()
            for name in names
            if getattr(getattr(self, part), name, None) is not None
        ]

    def bands(self, forces: CasingForces, *, weighted: bool) -> dict[str, Array]:
        """Sound power in third octaves by what radiates it, and of all. [W]."""
        powers = sound_powers(forces, self.casing, self.plate)
        frequency = forces.frequency
        weight = 10.0 ** (0.1 * a_weighting(frequency)) if weighted else 1.0
        found = {n: third_octave_sums(frequency, p * weight) for n, p in powers.items()}
        return {**found, _ALL: np.sum(list(found.values()), axis=0)}

    def levels(self, sources: Sequence[CasingForces]) -> Array:
        """A-weighted sound power levels of designs. [dB]."""
        power = [self.bands(forces, weighted=True)[_ALL].sum() for forces in sources]
        return np.asarray(sound_power_level(np.array(power)))


def _dataset(study: NoiseStudy, names: Sequence[str], records: Sequence[Record]) -> xr.Dataset:
    import xarray as xr

    structure = _Structure(study.casing, study.plate)
    sources = [_forces(record) for record in records]
    radiators = [*(r for r in RADIATORS if r != "plate" or study.plate is not None), _ALL]
    plain = [structure.bands(forces, weighted=False) for forces in sources]
    weighted = [structure.bands(forces, weighted=True) for forces in sources]
    level = np.asarray(sound_power_level(np.array([found[_ALL].sum() for found in weighted])))
    ripples = [_complex(record.numbers["ripple"])["ripple"] for record in records]
    by_design: dict[str, tuple[Any, str]] = {
        "sound_power_level_dBA": (level, "dB"),
        "sound_pressure_level_1m_dBA": (level - _AT_ONE_METRE, "dB"),
        "difference_dB": (level - level[0], "dB"),
        "pressure_ripple_rms_bar": (
            [math.sqrt(0.5 * float(np.sum(np.abs(z) ** 2))) / _BAR for z in ripples],
            "bar",
        ),
    }
    for name in radiators[:-1]:
        power = np.array([found[name].sum() for found in weighted])
        by_design[f"{name}_power_level_dBA"] = (sound_power_level(power), "dB")
    # all free parameters at once: a Latin hypercube over the logarithms of their factors
    shares = unit_samples(len(structure.free), "latin_hypercube", _DRAWS, _SEED)
    draws = [
        dict(zip(structure.free, row.tolist(), strict=True))
        for row in study.spread ** (2.0 * shares - 1.0)
    ]
    drawn = np.array([structure.changed(factors).levels(sources) for factors in draws])
    for name, values in (("sound_power_level", drawn), ("difference", drawn - drawn[:, :1])):
        suffix = "dBA" if name == "sound_power_level" else "dB"
        low, high = np.percentile(values, (5.0, 95.0), axis=0)
        by_design[f"{name}_low_{suffix}"] = (low, "dB")
        by_design[f"{name}_high_{suffix}"] = (high, "dB")
    free = [(path, f) for path in structure.free for f in (1.0 / study.spread, study.spread)]
    changed = np.array([structure.changed({path: f}).levels(sources) for path, f in free])
    most = max(sources, key=lambda forces: forces.order.size).order
    groups = [{n: z for g in _FORCES for n, z in getattr(s, g).items()} for s in sources]
    if study.plate is not None:
        for s, found in zip(sources, groups, strict=True):
            both = blocked_foot_forces(s, study.plate)
            found |= dict(zip(("foot_in_phase", "foot_against"), both, strict=True))
    labels = list(dict.fromkeys(name for found in groups for name in found))
    force = np.full((len(sources), len(labels), most.size), np.nan)
    pressure = np.full((len(sources), most.size), np.nan)
    for k, found in enumerate(groups):
        pressure[k, : ripples[k].size] = np.abs(ripples[k])
        for name, z in found.items():
            force[k, labels.index(name), : z.size] = np.abs(z)

    def banded(found: Sequence[Mapping[str, Array]]) -> Array:
        return np.asarray(sound_power_level(np.array([[f[r] for r in radiators] for f in found])))

    return xr.Dataset(
        {
            **{n: ("design", np.asarray(v), {"units": u}) for n, (v, u) in by_design.items()},
            "shaft_speed": ("design", [s.speed for s in sources], {"units": "rad/s"}),
            "sound_power_level": (
                ("design", "radiator", "band"), banded(plain), {"units": "dB"}
            ),
            "weighted_power_level": (
                ("design", "radiator", "band"), banded(weighted), {"units": "dB"}
            ),
            "force": (("design", "force_name", "order"), force, {"units": "N"}),
            "pressure_ripple": (("design", "order"), pressure, {"units": "Pa"}),
            "free_parameter": ("change", [path for path, _ in free]),
            "factor": ("change", [f for _, f in free], {"units": "1"}),
            "free_level": (("change", "design"), changed - level, {"units": "dB"}),
            "free_difference": (
                ("change", "design"), changed - changed[:, :1] - (level - level[0]), {"units": "dB"}
            ),
        },
        coords={
            "design": list(names),
            "radiator": radiators,
            "band": ("band", 1000.0 * 10.0 ** (0.1 * BAND_NUMBERS), {"units": "Hz"}),
            "force_name": labels,
            "order": most,
        },
    )  # fmt: skip


_FLOOR, _LEAST_DRAWN = 60.0, 1e-3
"""Range of levels [dB], and of forces of a design, that is drawn. [-]"""
_TICKS = ("100", "200", "400", "800", "1600", "3150", "6300")
_SHOWN = {
    "inside": "Pairs of forces inside (N)",
    "net": "Net force (N)",
    "net_moment": "Net moment (N m)",
}


def figures(data: xr.Dataset) -> list[StudyFigure]:
    """Levels with their ranges, third octaves, and forces on the casing in orders."""
    return [
        StudyFigure(
            "noise",
            "A-weighted sound power in third octaves; the levels of the designs and their "
            "differences to the first one, each with the range that the free parameters of casing "
            "and plate leave (5 to 95 %).",
            noise_levels(data),
        ),
        StudyFigure(
            "casing_forces",
            "Forces on the casing over the order of the shaft: root of the sum of squares of "
            "the pairs that deform it, and what the feet must hold.",
            force_spectra(data),
        ),
    ]


@styled
def noise_levels(data: xr.Dataset) -> Figure:
    """Third octaves of all designs, their levels and differences with ranges."""
    figure = new_figure(9.6, 4.4)
    grid = figure.add_gridspec(2, 2, width_ratios=(2.2, 1.0))
    bands = figure.add_subplot(grid[:, 0])
    names = [str(name) for name in data["design"].values]
    values = np.asarray(data["weighted_power_level"].sel(radiator=_ALL))
    centre = np.log10(np.asarray(data["band"]))
    width = 0.09 / len(names)
    highest = float(np.nanmax(values))
    for k, name in enumerate(names):
        height = np.maximum(np.nan_to_num(values[k], nan=-np.inf) - highest + _FLOOR, 0.0)
        place = centre + (k - 0.5 * (len(names) - 1)) * width
        label = f"{name}: {float(data['sound_power_level_dBA'][k]):.1f} dB(A)"
        bottom = highest - _FLOOR
        bands.bar(place, height, width, bottom=bottom, color=CYCLE[k % len(CYCLE)], label=label)
    bands.set_xticks(centre[::3], _TICKS)
    bands.set_ylim(highest - _FLOOR, highest + 4.0 + 3.0 * len(names))
    bands.set(xlabel="Third octave (Hz)", ylabel="A-weighted sound power level (dB re 1 pW)")
    bands.legend(loc="upper left")
    for row, (name, label) in enumerate(
        (("sound_power_level_{}_dBA", "Level (dB(A))"), ("difference_{}_dB", "Difference (dB)"))
    ):
        axes = figure.add_subplot(grid[row, 1])
        _ranges(axes, data, name, names)
        axes.set_xlabel(label)
    return figure


def _ranges(axes: Axes, data: xr.Dataset, name: str, names: Sequence[str]) -> None:
    middle, low, high = (
        np.asarray(data[name.replace("_{}", part)]) for part in ("", "_low", "_high")
    )
    for k in range(len(names)):
        color = CYCLE[k % len(CYCLE)]
        axes.plot([low[k], high[k]], [k, k], color=color, lw=3.0, alpha=0.5)
        axes.plot(middle[k], k, "o", color=color)
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.5, -0.5)


@styled
def force_spectra(data: xr.Dataset) -> Figure:
    """Amplitudes of the forces inside the casing and of those on its feet over the order."""
    figure = new_figure(9.0, 6.4)
    panels = figure.subplots(3, 1, sharex=True)
    labels = [str(name) for name in data["force_name"].values]
    order = np.asarray(data["order"])
    groups = {
        "inside": [n for n in labels if n.startswith(("journal_", "thrust_", "cover_"))],
        "net": ["net_x", "net_y"],
        "net_moment": ["net_moment_z"],
    }
    for axes, (group, title) in zip(panels, _SHOWN.items(), strict=True):
        for k, name in enumerate(data["design"].values):
            force = np.asarray(data["force"].sel(design=name, force_name=groups[group]))
            size = np.sqrt(np.nansum(force**2, axis=0))
            kept = size > _LEAST_DRAWN * size.max()
            axes.plot(order[kept], size[kept], ".", color=CYCLE[k % len(CYCLE)], label=str(name))
        axes.set_yscale("log")
        axes.set_ylabel(title)
    panels[0].legend()
    panels[-1].set_xlabel("Order of the shaft")
    return figure


STUDY = Study(NoiseStudy, run, figures)
