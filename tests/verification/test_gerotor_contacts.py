"""Contact tables of rotors against exact outlines and the law of gearing."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely
from scipy.spatial import cKDTree

from tests.drawn_rotors import (
    CAVITY,
    ECCENTRICITY,
    INNER_COUNT,
    LOBE_RADIUS,
    OUTER_COUNT,
    cycloidal,
    trochoidal,
)
from toothspace.core.errors import GeometryError
from toothspace.core.types import Array
from toothspace.machines.gerotor.contact_table import (
    NODES_PER_PITCH,
    LobeContact,
    export_contacts,
    lobe_contacts,
)
from toothspace.machines.gerotor.lobe_pairs import single_contact
from toothspace.machines.gerotor.parameters import RotorParameters
from toothspace.machines.gerotor.profiles import Rotors, rotors_from

CLEARANCE = 40e-6
DESIGNS = {"trochoidal": trochoidal, "cycloidal": cycloidal}


@pytest.fixture(scope="module", params=list(DESIGNS))
def design(request: pytest.FixtureRequest) -> tuple[Array, Array, tuple[LobeContact, ...]]:
    inner, outer = DESIGNS[request.param](CLEARANCE)
    rotors = Rotors(inner, outer, INNER_COUNT, ECCENTRICITY, CLEARANCE)
    return inner, outer, lobe_contacts(rotors)


def standing(
    inner: Array, outer: Array, angle: float, motion: tuple[float, float, float]
) -> tuple[Array, Array, Array]:
    """Inner outline, outer outline and displaced outer outline in the machine frame."""
    fixed = inner @ np.array([1.0, 1.0j]) * np.exp(1j * angle * OUTER_COUNT / INNER_COUNT)
    own = outer @ np.array([1.0, 1.0j])
    own = np.interp(np.arange(0, own.size, 0.25), np.arange(own.size), own)
    nominal = own * np.exp(1j * angle)
    return (
        fixed - 1j * ECCENTRICITY,
        nominal,
        nominal * np.exp(1j * motion[2]) + complex(motion[0], motion[1]),
    )


def polygon_distance(fixed: Array, points: Array) -> Array:
    """Signed distance of points from a polygon, negative within."""
    polygon = shapely.Polygon(np.column_stack([fixed.real, fixed.imag]))
    spots = shapely.points(points.real, points.imag)
    shapely.prepare(polygon)
    sign = np.where(shapely.contains(polygon, spots), -1.0, 1.0)
    return np.asarray(sign * shapely.distance(polygon.exterior, spots))


def errors(
    design: tuple[Array, Array, tuple[LobeContact, ...]], motion: tuple[float, float, float]
) -> Array:
    """Exact gap near every contact less the least one of the tables there, at four angles."""
    inner, outer, contacts = design
    found = []
    for node in (0, 17, 63, 101):
        angle = node * contacts[0].pitch / NODES_PER_PITCH
        fixed, nominal, moved = standing(inner, outer, angle, motion)
        place, gap = contacts_at(contacts, node, motion)
        for here in place:
            near = np.roll(np.arange(moved.size), -int(np.argmin(np.abs(nominal - here))) + 2000)
            near = near[:4000][np.abs(nominal[near[:4000]] - here) < 0.5e-3]
            rough, _ = cKDTree(columns(fixed)).query(columns(moved[near]))
            least = int(np.argmin(rough))
            # beyond the ends of the window another contact is nearer
            if 5 < least < near.size - 6:
                some = moved[near[max(0, least - 60) : least + 60]]
                exact = polygon_distance(fixed, some).min()
                found.append(exact - gap[np.abs(place - here) < 1e-3].min())
    return np.array(found)


def columns(points: Array) -> Array:
    """Complex numbers as rows of coordinates."""
    return np.column_stack([points.real, points.imag])


def contacts_at(
    contacts: tuple[LobeContact, ...], node: int, motion: tuple[float, float, float]
) -> tuple[Array, Array]:
    """Places and gaps of the contacts that exist at a node of the first pitch."""
    places, gaps = [], []
    for contact in contacts:
        rows = node + NODES_PER_PITCH * np.arange(contact.copies)
        rows = rows[contact.near[rows]]
        gaps.append(moved_gap(contact, motion)[rows])
        places.append(contact.outer_point[rows] @ np.array([1.0, 1.0j]))
    return np.concatenate(places), np.concatenate(gaps)


def moved_gap(contact: LobeContact, motion: tuple[float, float, float]) -> Array:
    """Gap of a displaced and turned outer rotor, to second order."""
    normal, turn = contact.normal, motion[2]
    gap = contact.gap + normal @ np.array(motion[:2]) + contact.lever * turn
    along = np.column_stack([-normal[:, 1], normal[:, 0]])
    shift = along @ np.array(motion[:2]) + np.sum(contact.outer_point * normal, axis=1) * turn
    by_shifts, mixed, by_turns = contact.second_derivatives(ECCENTRICITY).T
    second = by_shifts * shift**2 + 2.0 * mixed * shift * turn + by_turns * turn**2
    return np.asarray(gap + 0.5 * second, dtype=float)


def test_nominal_gap_is_the_distance_of_the_polygons(
    design: tuple[Array, Array, tuple[LobeContact, ...]],
) -> None:
    """The sharp corner between lobe and cavity of the trochoidal outline costs 0.2 um."""
    error = errors(design, (0.0, 0.0, 0.0))
    assert error.size > 4 * OUTER_COUNT
    assert np.abs(error).max() < 0.3e-6
    assert np.median(np.abs(error)) < 0.01e-6


@pytest.mark.parametrize("motion", [(30e-6, 20e-6, 1.5e-3), (-20e-6, 30e-6, -1.5e-3)])
def test_gap_against_displaced_polygons(
    design: tuple[Array, Array, tuple[LobeContact, ...]], motion: tuple[float, float, float]
) -> None:
    """Moved by 36 um and turned by 26 um at the pitch circle: to first order 25 nm and 0.8 um.

    Off where a tooth lies in a groove of nearly its own radius, along which the nearest place
    wanders: there curvatures hold for a part of the way alone.
    """
    size = np.abs(errors(design, motion))
    assert np.median(size) < 0.025e-6
    assert np.percentile(size, 80) < 0.05e-6
    assert np.percentile(size, 90) < 0.5e-6


def test_conjugate_rotors_keep_their_clearance_and_roll_about_the_pitch_point(
    design: tuple[Array, Array, tuple[LobeContact, ...]],
) -> None:
    """Law of gearing: all normals of the contact that carries pass through the pitch point."""
    contact = max(design[2], key=lambda c: c.copies)
    inside = steady(contact)
    assert np.abs(contact.gap[inside] - CLEARANCE).max() < 0.05e-6
    arm = contact.outer_point[inside] - [0.0, -OUTER_COUNT * ECCENTRICITY]
    n = contact.normal[inside]
    assert np.abs(arm[:, 0] * n[:, 1] - arm[:, 1] * n[:, 0]).max() < 3e-5
    turns = OUTER_COUNT / INNER_COUNT - 1.0
    slip = np.abs(np.sum(arm * n, axis=1)) * turns
    assert np.abs(contact.sliding[inside]) == pytest.approx(slip, abs=5e-5)


def test_gap_rate_is_the_derivative_of_the_gap(
    design: tuple[Array, Array, tuple[LobeContact, ...]],
) -> None:
    for contact in design[2]:
        step = contact.period / contact.gap.size
        slope = (np.roll(contact.gap, -1) - np.roll(contact.gap, 1)) / (2.0 * step)
        inside = steady(contact)
        assert np.abs(slope - contact.gap_rate)[inside].max() < 2e-5


def steady(contact: LobeContact) -> Array:
    """Nodes away from the ends of a contact's life."""
    near = contact.near.copy()
    for _ in range(10):
        near &= np.roll(near, 1) & np.roll(near, -1)
    return np.flatnonzero(near)


def test_exported_table_holds_the_contacts(
    design: tuple[Array, Array, tuple[LobeContact, ...]], tmp_path: Path
) -> None:
    contact = design[2][0]
    export_contacts(tmp_path / "contacts.txt", design[2][:1])
    table = np.loadtxt(tmp_path / "contacts.txt")
    assert table.shape == (np.count_nonzero(contact.near), 12)
    assert table[:, 1] == pytest.approx(contact.gap[contact.near], abs=1e-12)
    assert table[:, 7] == pytest.approx(contact.lever[contact.near], abs=1e-9)


def test_trochoidal_lobes_keep_their_radius() -> None:
    inner, outer = trochoidal(CLEARANCE)
    rotors = Rotors(inner, outer, INNER_COUNT, ECCENTRICITY, CLEARANCE)
    lobe, cavity = lobe_contacts(rotors)
    assert (lobe.copies, cavity.copies) == (OUTER_COUNT, 1)
    assert lobe.radius_outer == pytest.approx(LOBE_RADIUS, rel=1e-3)
    assert cavity.radius_outer[steady(cavity)] == pytest.approx(-CAVITY, rel=1e-3)


def test_rough_outlines_are_refused() -> None:
    """Noise of 1 um from point to point: a minimum on every bump."""
    noise = np.random.default_rng(1)
    inner, outer = (
        points + noise.normal(0.0, 1e-6, points.shape) for points in trochoidal(CLEARANCE)
    )
    rotors = Rotors(inner, outer, INNER_COUNT, ECCENTRICITY, CLEARANCE)
    with pytest.raises(GeometryError, match="smooth profiles"):
        lobe_contacts(rotors)


@pytest.mark.parametrize("count", [4, 9])
@pytest.mark.parametrize("kind", ["trochoidal", "cycloidal"])
def test_any_tooth_count_has_one_endless_set_of_contacts(kind: str, count: int) -> None:
    """One more contact than the inner rotor has teeth, each at the clearance of the design."""
    eccentricity = 15e-3 / (count + 1)
    design = RotorParameters(
        kind=kind,
        inner_tooth_count=count,
        eccentricity=eccentricity,
        generating_radius=1.5 * (count + 1) * eccentricity if kind == "trochoidal" else None,
        lobe_radius=2.0 * eccentricity if kind == "trochoidal" else None,
        face_width=10e-3,
        tip_clearance=30e-6,
    )
    contact = lobe_contacts(rotors_from(design))[0]
    assert count + 1 <= contact.copies <= count + 2
    gap = contact.gap[steady(contact)]
    assert gap == pytest.approx(30e-6, abs=0.1e-6)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_single_contact_theory_leaves_one_pair_over_one_pitch(
    design: tuple[Array, Array, tuple[LobeContact, ...]], sign: float
) -> None:
    """Where its least arm is the largest; beyond, the gap opens and then nothing touches."""
    contact = design[2][0]
    alone = single_contact(contact, sign, ECCENTRICITY)
    pitch = contact.gap.size // contact.copies
    kept = np.flatnonzero((alone.gap == contact.gap) & contact.near)
    inside = np.mod(kept - kept[0] + contact.gap.size // 2, contact.gap.size)
    assert pitch - 1 <= kept.size <= pitch + 2
    assert np.ptp(inside) <= pitch + 1
    arm = np.where(contact.near, sign * contact.lever, -np.inf)
    windows = np.stack([np.roll(arm, -k)[: pitch + 1].min() for k in range(arm.size)])
    assert arm[kept].min() >= windows.max() - 1e-12
    assert alone.gap.min() >= contact.gap.min()
    assert np.all(alone.gap >= contact.gap - 1e-15)
    assert np.count_nonzero(alone.near) <= 2 * pitch
    # the rate is the slope of the gap over the angle
    step = contact.pitch / pitch
    slope = (np.roll(alone.gap, -1) - np.roll(alone.gap, 1)) / (2.0 * step)
    smooth = alone.near & np.roll(alone.near, 1) & np.roll(alone.near, -1)
    scale = np.abs(slope[smooth]).max()
    assert np.mean(np.abs(alone.gap_rate - slope)[smooth] > 0.05 * scale) < 0.05
