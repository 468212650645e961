"""Every claim about films, gerotor and fuel pump fails where its result is spoiled."""

from __future__ import annotations

from dataclasses import dataclass, replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr

from toothspace.core.status import Status
from toothspace.results.tooth_contacts import ToothContacts
from toothspace.validation import book, gerotor, lateral, published_films, reference_machines

CHECKED = tuple(
    claim
    for claim in (
        *published_films.CLAIMS,
        *gerotor.CLAIMS,
        *lateral.CLAIMS,
        *reference_machines.SERVICE_MANUAL_CLAIMS,
    )
    if claim.measure is not None
)
BY_KEY = {claim.key: claim for claim in CHECKED}


def verdict(key: str) -> str:
    return book.examine(BY_KEY[key], "short").verdict


# films: results that are off by 30 % from what is published, by way of the published numbers

PUBLISHED = {
    "raimondi_boyd_load": "sommerfeld_number",
    "butenschoen_rotation": "Q",
    "lund_thomsen_coefficients": "Kxy",
    "elrod_groove": "M_fr_Nm",
    "bertocchi_pocket": "p_small_pocket",
    "comsol_pressure": "p_bar",
}


@pytest.mark.parametrize("key", PUBLISHED)
def test_films_that_are_off_by_a_third(key: str, monkeypatch: pytest.MonkeyPatch) -> None:
    honest = published_films.columns

    def spoiled(source: str, name: str = "reference.csv") -> dict[str, Any]:
        found = honest(source, name)
        return {k: v * 1.3 if k == PUBLISHED[key] else v for k, v in found.items()}

    monkeypatch.setattr(published_films, "columns", spoiled)
    assert verdict(key) == "fail"


def test_friction_curve_that_is_off_by_a_third(monkeypatch: pytest.MonkeyPatch) -> None:
    honest = published_films.PUBLISHED_CURVE
    monkeypatch.setattr(published_films, "PUBLISHED_CURVE", lambda s: 1.3 * np.asarray(honest(s)))
    assert verdict("pawar_eq_2_7") == "fail"


# gerotor: a result by hand, good or with one number spoiled


@dataclass(frozen=True)
class Pump:
    """What claims ask of a run of the gerotor."""

    one_tooth: float = 0.02
    """Part of the turn with one tooth loaded. [-]"""
    three_teeth: float = 0.02
    gap_friction: float = 0.24
    contact_friction: float = 0.2
    torque: float = 3.9
    growth: float = 0.1
    """Of the torque from one speed to the next. [N m]"""
    other_order: float = 0.0
    """Amplitude of an order that is none of the teeth, over that of the teeth. [-]"""
    single: float = 3.0
    """Ripple with a single contact over that with all. [-]"""
    films_off: float = 1.0
    """Leakage of the closed forms over that of solved films. [-]"""

    def run(self, case: str, *overrides: str) -> Any:
        text = " ".join(overrides)
        speed = float(text.partition("shaft_speed=")[2].partition(" ")[0] or 767.0)
        torque = self.torque + self.growth * np.log2(speed / 500.0)
        angle = np.linspace(0.0, 2.0 * np.pi, 721)
        swing = 0.1 * (self.single if "theory=single" in text else 1.0)
        wave = torque + swing * (np.sin(6 * angle) + self.other_order * np.sin(5 * angle))
        count = np.full(angle.size, 2)
        count[: int(self.one_tooth * angle.size)] = 1
        count[-int(self.three_teeth * angle.size) - 1 :] = 3 if self.three_teeth else 2
        force = np.where(np.arange(7) < count[:, None], 100.0, 0.0)
        losses = {
            "journal_viscous": 0.3 * self.gap_friction,
            "lateral_viscous": 0.7 * self.gap_friction,
            "contact_friction": self.contact_friction,
        }
        data = xr.Dataset(
            {
                "shaft_torque": ("shaft_angle", wave),
                "torque_loss": (("shaft_angle", "mechanism"), [list(losses.values())] * angle.size),
            },
            coords={"shaft_angle": angle, "mechanism": list(losses)},
        )
        off = 1.0 if "fidelity=films" in text else self.films_off
        numbers = {
            "mean_torque_N_m": torque,
            "volumetric_efficiency": 0.92,
            "leakage_tip_L_per_min": 0.2 * off,
        }
        return SimpleNamespace(
            data=data,
            summary=lambda: numbers,
            tooth_contacts=lambda: ToothContacts(force, np.zeros_like(force)),
        )


SPOILED_PUMPS = {
    "gerotor_teeth": {"one_tooth": 0.2},
    "gerotor_three": {"three_teeth": 0.0},
    "gerotor_span": {"one_tooth": 0.6},
    "gerotor_walls": {"one_tooth": 0.2},
    "gerotor_losses": {"contact_friction": 0.3},
    "gerotor_speed": {"growth": -0.1},
    "gerotor_speed_films": {"growth": 0.01},
    "gerotor_steps": {"single": 1.0},
    "gerotor_orders": {"other_order": 0.5},
    "gerotor_closed_forms": {"films_off": 1.5},
}


@pytest.mark.parametrize("key", SPOILED_PUMPS)
def test_gerotor(key: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(gerotor, "solved", Pump().run)
    assert verdict(key) == "pass"
    monkeypatch.setattr(gerotor, "solved", Pump(**SPOILED_PUMPS[key]).run)
    assert verdict(key) == "fail"


# fuel pump: a loop and a nose study by hand


@dataclass(frozen=True)
class Loop:
    """Films and positions of a study. [um]"""

    films: tuple[float, ...]
    positions: tuple[float, ...]
    status: Status = Status.DONE

    @property
    def points(self) -> list[Any]:
        return [
            SimpleNamespace(
                numbers=SimpleNamespace(gaps=np.full(4, film * 1e-6), position=place * 1e-6),
                films=("floating_drive", "floating_driven", "solid_drive", "solid_driven"),
            )
            for film, place in zip(self.films, self.positions, strict=True)
        ]

    @property
    def held_by_friction(self) -> tuple[bool, ...]:
        return (False,) * len(self.films)

    @property
    def outlet_pressures(self) -> tuple[float, ...]:
        return (1.0,) * len(self.films)

    def dataset(self) -> None:
        return None


GOOD = Loop((1.7, 1.9, 2.4, 3.8, 2.8, 2.1, 1.8), (3.0, 3.2, 4.0, 6.0, 4.6, 3.4, 3.1))
FLAT = replace(GOOD, films=(1.7, 1.71, 2.4, 3.8, 2.8, 2.1, 1.8))
BACK = replace(GOOD, films=(1.7, 1.9, 2.4, 3.8, 2.8, 2.1, 1.72))
LOW = replace(GOOD, positions=(3.0, 2.9, 4.0, 6.0, 4.6, 3.4, 3.1))
NOSE = Loop((2.0,) * 6, (3.0, 2.9, 3.1, 3.0, 4.0, 4.0))
STUCK = replace(NOSE, positions=(3.0, 2.98, 3.1, 3.0, 4.0, 4.0))


@pytest.mark.parametrize(
    ("key", "good", "spoiled"),
    [
        ("fuel_pump_loop_055", GOOD, FLAT),
        ("fuel_pump_second_leg", GOOD, BACK),
        ("fuel_pump_loop_078", GOOD, LOW),
        ("fuel_pump_nose", NOSE, STUCK),
    ],
)
def test_fuel_pump(key: str, good: Loop, spoiled: Loop, monkeypatch: pytest.MonkeyPatch) -> None:
    for study, expected in ((good, "pass"), (spoiled, "fail")):
        monkeypatch.setattr(lateral, "_loop", lambda *_, found=study: found)
        monkeypatch.setattr(lateral, "solve_path", lambda *_, found=study: found)
        assert verdict(key) == expected


def test_speed_of_the_fuel_pump(monkeypatch: pytest.MonkeyPatch) -> None:
    for fast, expected in ((9200.0, "pass"), (9500.0, "fail")):
        forces = 9000.0, fast, 300.0, 130.0
        monkeypatch.setattr(lateral, "opening_forces", lambda _, found=forces: found)
        assert verdict("fuel_pump_speed") == expected


@pytest.mark.parametrize("key", [c.key for c in CHECKED if c.key.startswith("manual_")])
def test_pump_of_a_manual(key: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Enough at the slow point is not enough at the fast one."""
    for flow, expected in ((60.0, "pass"), (10.0, "fail")):
        numbers = {"mean_flow_L_per_min": flow, "volumetric_efficiency": 0.9}
        solution = SimpleNamespace(summary=lambda found=numbers: found)
        monkeypatch.setattr(reference_machines, "solved", lambda *_, found=solution: found)
        assert verdict(key) == expected


def test_every_claim_is_tried() -> None:
    tried = {*PUBLISHED, "pawar_eq_2_7", *SPOILED_PUMPS, "fuel_pump_loop_055", "fuel_pump_speed"}
    tried |= {"fuel_pump_second_leg", "fuel_pump_loop_078", "fuel_pump_nose"}
    tried |= {key for key in BY_KEY if key.startswith("manual_")}
    assert tried == set(BY_KEY)
