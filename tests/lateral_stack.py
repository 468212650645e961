"""A bearing pressed against one plain ring between two films, for tests of the force balance."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from toothspace.films import FilmFluid
from toothspace.films.definitions import RoughSurfaces
from toothspace.floating.face_film import film_law
from toothspace.floating.face_grid import FaceGrid
from toothspace.floating.housing_friction import housing_friction
from toothspace.floating.motion import Loads
from toothspace.floating.stack import BackPressure, Stack, WinklerFoundation
from toothspace.model.film_faces import (
    FILM,
    NO_BODY,
    ChamberRing,
    FaceBody,
    FaceCells,
    FaceSurfaces,
    FilmFace,
)
from toothspace.model.floating_bearing import (
    AxialForce,
    FilmInterface,
    FloatingBearing,
    HousingContact,
    LateralBalance,
    Patch,
)
from toothspace.studies.bearing_points import PointCondition

INNER, OUTER, VISCOSITY = 10e-3, 25e-3, 1e-3
AREA = np.pi * (OUTER**2 - INNER**2)
LOW, HIGH = 5e5, 60e5
LOW_NODE, HIGH_NODE = 0, 1
PLACES = ((0.0, 0.0), (5e-3, 0.1))
ROUGH = RoughSurfaces(
    moving_roughness=0.25e-6,
    resting_roughness=0.3e-6,
    effective_modulus=1.5e11,
    hardness=1e9,
)


@dataclass(frozen=True)
class RingFace:
    """Film on a ring; beyond the rim high pressure where x is above a limit."""

    limit: float = -1.0

    def __call__(self, shaft_angle: float, x: np.ndarray, y: np.ndarray) -> FaceCells:
        inside = np.hypot(x, y) <= OUTER
        outside = np.where(x > self.limit, HIGH_NODE, LOW_NODE)
        return FaceCells(np.where(inside, FILM, outside), np.where(inside, 0, NO_BODY))


def ring_stack(
    *,
    high_share: float = 0.5,
    approach: float = 0.0,
    rough: bool = True,
    limit: float = -1.0,
    motion: str = "axial",
    arrangement: str = "asymmetric",
    preload: float = 100.0,
    preload_x: float = 0.0,
    cells: tuple[int, int] = (36, 10),
    speed: float = 300.0,
) -> Stack:
    """Stack of one ring; ``high_share`` is the part of the back face at high pressure."""
    interfaces = tuple(
        FilmInterface(
            name=f"{side}_ring",
            body="ring",
            side=side,
            face=FilmFace(
                bodies=(FaceBody("ring", (0.0, 0.0), OUTER),),
                center=(0.0, 0.0),
                inner_radius=INNER,
                outer_radius=OUTER,
                gap=10e-6,
                face_map=RingFace(limit),
                chambers=ChamberRing(np.array([HIGH_NODE]), np.zeros(1)),
                recesses=np.zeros(0, dtype=np.int64),
                inner_node=LOW_NODE,
                surfaces=FaceSurfaces(0.0, 0.0, effective_modulus=1.5e11, hardness=1e9),
            ),
            speed_ratio=1.0,
        )
        for side in ("floating", "solid")
    )
    floating = FloatingBearing(
        mass=0.3,
        face=Patch(AREA, (0.0, 0.0)),
        high_pressure=Patch(high_share * AREA, (0.0, 0.0)),
        nose=Patch(0.0, (0.0, 0.0)),
        preload=AxialForce(preload, (preload_x, 0.0)),
        housing=HousingContact(),
        gauge_point=(0.0, -OUTER),
        axial_play=100e-6,
    )
    balance = LateralBalance(
        arrangement=arrangement,  # type: ignore[arg-type]
        motion=motion,  # type: ignore[arg-type]
        interfaces=interfaces,
        floating=floating,
        high_node=HIGH_NODE,
        low_node=LOW_NODE,
        body_forces=(AxialForce(0.0),),
        body_masses=(0.5,),
    )
    law = film_law(ROUGH if rough else None, FilmFluid(VISCOSITY))
    grids = tuple(FaceGrid(i, *cells) for i in interfaces)
    return Stack(balance, grids, (law, law), WinklerFoundation((approach, approach)), speed)


@dataclass(frozen=True)
class _Moved:
    """Ring about another centre."""

    face: RingFace
    center: tuple[float, float]

    def __call__(self, shaft_angle: float, x: np.ndarray, y: np.ndarray) -> FaceCells:
        return self.face(shaft_angle, x - self.center[0], y - self.center[1])


def _half(own: FloatingBearing, place: tuple[float, float], share: float) -> FloatingBearing:
    x, y = place
    high = Patch(share * AREA, (x + own.high_pressure.center[0], y))
    springs = AxialForce(own.preload.size, (x + own.preload.place[0], y + own.preload.place[1]))
    gauge = (x, y - OUTER)
    return replace(
        own, face=Patch(AREA, place), high_pressure=high, preload=springs, gauge_point=gauge
    )


def split_stack(shares: tuple[float, float], **changes: object) -> Stack:
    """Two rings side by side, each with its own half of the bearing, known to its films."""
    one = ring_stack(high_share=shares[0], **changes)  # type: ignore[arg-type]
    balance = one.balance
    interfaces = tuple(
        replace(
            i,
            name=f"{i.side}_{k}",
            body=f"ring_{k}",
            part=f"{i.side}_{k}",
            face=replace(
                i.face,
                bodies=(FaceBody(f"ring_{k}", place, OUTER),),
                center=place,
                face_map=_Moved(i.face.face_map, place),  # type: ignore[arg-type]
            ),
        )
        for i in balance.interfaces
        for k, place in enumerate(PLACES)
    )
    halves = tuple(_half(balance.floating, p, s) for p, s in zip(PLACES, shares, strict=True))
    split = replace(
        balance,
        interfaces=interfaces,
        halves=halves,
        body_forces=(AxialForce(0.0),) * 2,
        body_masses=(0.5, 0.5),
    )
    cells = one.grids[0]
    grids = tuple(FaceGrid(i, cells.rows, cells.lanes) for i in interfaces)
    return Stack(
        split, grids, one.laws[:1] * 4, WinklerFoundation(one.compliance.local * 2), one.shaft_speed
    )


def loads(high: float, coulomb: float = 0.0, law: str = "stick") -> Loads:
    """Pressures behind the bearing with a friction force in the housing."""
    contact = replace(HousingContact(), friction_coefficient=0.01, law=law)
    return Loads(BackPressure(high, LOW, LOW), housing_friction(contact, coulomb / 0.01))


def pressures(high: float, low: float = LOW) -> np.ndarray:
    """Pressures of both nodes. [Pa]."""
    return np.array([low, high])


def conditions(*pressures: float) -> tuple[PointCondition, ...]:
    """Points of a study at outlet pressures. [Pa]."""
    return tuple(
        PointCondition(label=f"A, {k}", outlet_pressure=p, inlet_pressure=1e5, shaft_speed=1.0)
        for k, p in enumerate(pressures)
    )
