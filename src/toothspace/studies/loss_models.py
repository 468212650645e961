"""Loss coefficients of an efficiency map: models of Wilson and Schlösser, and a polynomial."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.core.types import Array
from toothspace.results.exchange import is_map, machine_map
from toothspace.studies.study import StudyTable

if TYPE_CHECKING:
    import xarray as xr

_LITRE_PER_MINUTE = 6e4
_ORDER = 2
"""Highest power of speed and of pressure difference in the polynomial."""
_CONFIDENCE = 0.95


@final
@dataclass(frozen=True)
class LossFit:
    """One loss of a map by one model."""

    model: str
    """``wilson``, ``schloesser`` or ``polynomial``."""
    loss: str
    """``flow`` or ``torque``."""
    names: tuple[str, ...]
    """Coefficients."""
    units: tuple[str, ...]
    """Their units."""
    values: Array
    """Their values. [unit of the coefficient]"""
    half_widths: Array
    """Half the width of their 95 % intervals, infinite where points are as few as they. [as before]
    """
    residuals: Array
    """Loss of the map less that of the model, at the points. [m3/s] or [N m]"""

    @property
    def error(self) -> float:
        """Root mean square of the residuals. [m3/s] or [N m]."""
        return float(np.sqrt(np.mean(self.residuals**2)))


def fit_losses(
    data: xr.Dataset, *, motor: bool, dynamic_viscosity: float, density: float
) -> tuple[LossFit, ...]:
    r"""Fit models of lost flow and lost torque to a map, by least squares.

    Parameters
    ----------
    data : xarray.Dataset
        Map over ``shaft_speed`` [rad/s] and ``pressure_difference`` [Pa] with displacement, flow
        and torque.
    motor : bool
        Whether the machine is a motor, whose losses raise the flow and lower the torque.
    dynamic_viscosity, density : float
        Viscosity [Pa s] and density [kg/m3] of the liquid that the coefficients refer to.

    Returns
    -------
    tuple of LossFit
        Flow and torque of each model with fewer coefficients than the map has points; none for a
        map without these numbers.

    Notes
    -----
    With displacement :math:`V` per radian, speed :math:`\omega`, pressure difference
    :math:`\Delta p`, viscosity :math:`\mu` and density :math:`\rho`, Wilson [1]_, [3]_:

    .. math:: Q_l = c_s \frac{V \Delta p}{\mu},\qquad
              T_l = c_v V \mu \omega + c_f V \Delta p + T_c

    Schlösser [3]_, who adds turbulent leakage and losses of inertia:

    .. math:: Q_l = c_s \frac{V \Delta p}{\mu} + c_t V^{2/3} \sqrt{\frac{2 \Delta p}{\rho}},\qquad
              T_l = c_v V \mu \omega + c_f V \Delta p + c_h \rho V^{5/3} \omega^2 + T_c

    Polynomial of Ivantysyn and Ivantysynova [2]_ for one displacement, with speed and pressure
    difference over their largest values of the map:

    .. math:: Q_l,\ T_l = \sum_{i=0}^{2} \sum_{j=0}^{2} k_{ij}
              \left(\frac{\omega}{\omega_m}\right)^i \left(\frac{\Delta p}{\Delta p_m}\right)^j

    The displacement per radian in place of that per turn is our choice; it only scales
    coefficients. All points weigh alike. Intervals assume independent, normal residuals. Those of a
    computed map are neither, so an interval only tells how well a coefficient is determined.

    References
    ----------
    .. [1] W. E. Wilson, *Positive-Displacement Pumps and Fluid Motors*, Pitman, 1950.
    .. [2] J. Ivantysyn, M. Ivantysynova, *Hydrostatic Pumps and Motors*, 2001.
    .. [3] S. J. Hall, *Statistical analysis of multiple hydrostatic pump flow loss models*, thesis,
       Iowa State University, 2014, chapter 2, lib.dr.iastate.edu/etd/13753.
    """
    if not is_map(data):
        return ()
    table = machine_map(data.assign_attrs(mode="motor" if motor else "pump"))
    known = np.isfinite(table.flow + table.torque)
    if not known.any():
        return ()
    speed, pressure = (
        x[known] for x in np.meshgrid(table.shaft_speed, table.pressure_difference, indexing="ij")
    )
    volume = table.displacement
    lost = {"flow": table.flow_loss[known], "torque": table.torque_loss[known]}
    fits = []
    for model, losses in _models(speed, pressure, volume, dynamic_viscosity, density).items():
        for loss, columns in losses.items():
            matrix = np.column_stack([column for column, _ in columns.values()])
            scale = np.abs(matrix).max(axis=0)
            scale[scale == 0.0] = 1.0
            if len(speed) < len(columns) or np.linalg.matrix_rank(matrix / scale) < len(columns):
                continue
            values, spread, residuals = _least_squares(matrix / scale, lost[loss])
            units = tuple(unit for _, unit in columns.values())
            factors = np.array([_LITRE_PER_MINUTE if u == "L/min" else 1.0 for u in units]) / scale
            fits.append(
                LossFit(
                    model,
                    loss,
                    tuple(columns),
                    units,
                    values * factors,
                    spread * factors,
                    residuals,
                )
            )
    return tuple(fits)


def _models(
    speed: Array, pressure: Array, volume: float, viscosity: float, density: float
) -> dict[str, dict[str, dict[str, tuple[Array, str]]]]:
    """Losses of each model as columns per coefficient, with units of the coefficients."""
    slip = {"slip": (volume * pressure / viscosity, "1")}
    turbulent = volume ** (2.0 / 3.0) * np.sqrt(2.0 * np.abs(pressure) / density)
    viscous = {
        "viscous_friction": (volume * viscosity * speed, "1"),
        "pressure_friction": (volume * pressure, "1"),
    }
    constant = {"constant_torque": (np.ones_like(speed), "N m")}
    inertia = {"inertia": (density * volume ** (5.0 / 3.0) * speed**2, "1")}
    over_speed, over_pressure = speed / speed.max(), pressure / pressure.max()
    powers = {
        (i, j): over_speed**i * over_pressure**j
        for i in range(_ORDER + 1)
        for j in range(_ORDER + 1)
    }
    return {
        "wilson": {"flow": slip, "torque": viscous | constant},
        "schloesser": {
            "flow": slip | {"turbulent_slip": (np.sign(pressure) * turbulent, "1")},
            "torque": viscous | inertia | constant,
        },
        "polynomial": {
            loss: {f"k{i}{j}": (column, unit) for (i, j), column in powers.items()}
            for loss, unit in (("flow", "L/min"), ("torque", "N m"))
        },
    }


def _least_squares(matrix: Array, wanted: Array) -> tuple[Array, Array, Array]:
    """Coefficients, half widths of their intervals, residuals."""
    from scipy.stats import t

    rows, count = matrix.shape
    values = np.asarray(np.linalg.lstsq(matrix, wanted, rcond=None)[0], dtype=float)
    residuals = wanted - matrix @ values
    if rows == count:
        return values, np.full(count, np.inf, dtype=float), residuals
    variance = float(residuals @ residuals) / (rows - count)
    spread = np.sqrt(variance * np.diag(np.linalg.inv(matrix.T @ matrix)))
    factor = float(t.ppf(0.5 + 0.5 * _CONFIDENCE, rows - count))
    return values, np.asarray(factor * spread, dtype=float), residuals


def loss_numbers(fits: Sequence[LossFit]) -> dict[str, float]:
    """Coefficients of Wilson and Schlösser, and what each model misses, by summary names."""
    numbers = {}
    for fit in fits:
        factor, unit = (_LITRE_PER_MINUTE, "L_per_min") if fit.loss == "flow" else (1.0, "N_m")
        if fit.model != "polynomial":
            for name, value, own in zip(fit.names, fit.values, fit.units, strict=True):
                numbers[f"{fit.model}_{name}" + "_N_m" * (own == "N m")] = float(value)
        numbers[f"{fit.model}_{fit.loss}_error_{unit}"] = factor * fit.error
    return numbers


def loss_table(fits: Sequence[LossFit]) -> StudyTable:
    """Table of all coefficients with their intervals and the errors of their model."""
    rows = []
    for fit in fits:
        factor, unit = (_LITRE_PER_MINUTE, "L/min") if fit.loss == "flow" else (1.0, "N m")
        errors = factor * fit.error, factor * float(np.abs(fit.residuals).max())
        for name, own, value, width in zip(
            fit.names, fit.units, fit.values, fit.half_widths, strict=True
        ):
            rows.append((fit.model, fit.loss, name, float(value), float(width), own, *errors, unit))
    head = ("model", "loss", "coefficient", "value", "half width of 95 % interval", "unit")
    return StudyTable(
        "loss_coefficients", (*head, "rms error", "largest error", "unit of errors"), tuple(rows)
    )


def loss_data(fits: Sequence[LossFit]) -> Mapping[str, Any]:
    """Variables of the coefficients over ``loss_coefficient``, for a dataset."""
    over = "loss_coefficient"
    labels = [f"{fit.model} {fit.loss} {name}" for fit in fits for name in fit.names]
    return {
        over: (over, np.array(labels, dtype=str)),
        f"{over}_value": (
            over,
            np.concatenate([fit.values for fit in fits]),
            {"long_name": "Coefficient of a loss model, in the unit of loss_coefficient_unit"},
        ),
        f"{over}_half_width": (
            over,
            np.concatenate([fit.half_widths for fit in fits]),
            {"long_name": "Half the width of its 95 % interval"},
        ),
        f"{over}_unit": (over, np.array([u for fit in fits for u in fit.units], dtype=str)),
    }
