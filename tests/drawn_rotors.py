"""Two published rotor pairs with 6/7 teeth, drawn from their definitions."""

from __future__ import annotations

import numpy as np
import shapely

from toothspace.core.types import Array

ECCENTRICITY = 2.5e-3
INNER_COUNT, OUTER_COUNT = 6, 7
LOBE_CENTERS, LOBE_RADIUS, CAVITY = 25.2e-3, 8.5e-3, 21.7e-3


def trochoidal(clearance: float) -> tuple[Array, Array]:
    """Outlines with a tooth of either rotor at +y; lobes are circles, the inner an envelope."""
    turn = np.linspace(0.0, 2.0 * np.pi * INNER_COUNT, 6000, endpoint=False)
    ratio = OUTER_COUNT / INNER_COUNT
    path = 1j * (LOBE_CENTERS * np.exp(1j * (1.0 - ratio) * turn))
    path += 1j * ECCENTRICITY * np.exp(-1j * ratio * turn)
    rate = (1.0 - ratio) * 1j * 1j * LOBE_CENTERS * np.exp(1j * (1.0 - ratio) * turn)
    rate += ratio * ECCENTRICITY * np.exp(-1j * ratio * turn)
    # the lobe's centre goes round clockwise: its left side is away from the inner rotor
    inner = path - 1j * rate / np.abs(rate) * LOBE_RADIUS
    disc = shapely.Point(0.0, 0.0).buffer(CAVITY, quad_segs=1500)
    for k in range(OUTER_COUNT):
        center = 1j * LOBE_CENTERS * np.exp(2j * np.pi * k / OUTER_COUNT)
        lobe = shapely.Point(center.real, center.imag).buffer(LOBE_RADIUS, quad_segs=1500)
        disc = disc.difference(lobe)
    return _narrowed(inner[::-1], clearance), _ring(disc)


def cycloidal(clearance: float) -> tuple[Array, Array]:
    """Outlines with a tooth of either rotor at +y, from epi- and hypocycloids."""
    inner = _cycloid(INNER_COUNT, tip_first=True)
    outer = _cycloid(OUTER_COUNT, tip_first=False)
    return _narrowed(inner, clearance), np.column_stack([outer.real, outer.imag])


def _cycloid(count: int, tip_first: bool) -> Array:
    rolling = 0.5 * ECCENTRICITY
    base = count * ECCENTRICITY
    width = 2.0 * np.pi * rolling / base
    t = np.linspace(0.0, width, 500, endpoint=False)
    epi = (base + rolling) * np.exp(1j * t) - rolling * np.exp(1j * (base + rolling) * t / rolling)
    hypo = (base - rolling) * np.exp(1j * t) + rolling * np.exp(
        -1j * (base - rolling) * t / rolling
    )
    tooth = np.concatenate([epi, hypo * np.exp(1j * width)])
    start = 0.5 * np.pi - (0.5 if tip_first else 1.5) * width
    turns = np.exp(1j * (start + 2.0 * np.pi * np.arange(count) / count))
    return np.asarray((turns[:, None] * tooth).ravel())


def _narrowed(outline: Array, clearance: float) -> Array:
    shape = shapely.Polygon(np.column_stack([outline.real, outline.imag]))
    return _ring(shape.buffer(-clearance, quad_segs=64) if clearance else shape)


def _ring(shape: shapely.Polygon) -> Array:
    oriented = shapely.geometry.polygon.orient(shape)
    return np.array(oriented.exterior.coords)[:-1]
