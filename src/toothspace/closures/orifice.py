"""Flow through openings: one law from creeping flow to jets."""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.core.compiled import inlined

DISCHARGE_COEFFICIENT = 0.7
"""Discharge coefficient of ports and grooves at high Reynolds number. [-]"""

TRANSITION_REYNOLDS_NUMBER = 350.0
"""Reynolds number of the laminar start of ports and grooves: slope of the tanh law at its usual
critical flow number of 1000 (sharp thin orifices: 10 to 50, Borutzky 2002). [-]"""


@inlined
def inertial_laminar_flow(
    pressure_drop: Any, laminar_conductance: Any, discharge_area: Any, density: Any
) -> Any:
    r"""Flow rate of any path: a laminar and a kinetic pressure loss in series.

    Parameters
    ----------
    pressure_drop : float or ndarray
        Upstream minus downstream pressure. [Pa]
    laminar_conductance : float or ndarray
        Flow rate per pressure drop in creeping flow, zero for a closed path. [m3/(s Pa)]
    discharge_area : float or ndarray
        Discharge coefficient times area; infinite for no kinetic loss. [m2]
    density : float or ndarray
        Density of the fluid in the path. [kg/m3]

    Returns
    -------
    flow_rate : float or ndarray
        Volumetric flow rate, positive towards downstream. [m3/s]
    flow_rate_by_pressure : float or ndarray
        Derivative with respect to the pressure drop. [m3/(s Pa)]
    flow_rate_by_conductance : float or ndarray
        Derivative with respect to the conductance at fixed area. [Pa]

    Notes
    -----
    .. math:: \Delta p = \frac{Q}{G} + \frac{\rho}{2 A_d^2} Q |Q|

    solved for Q without cancellation: odd, monotone and once continuously differentiable.
    With the conductance of :func:`orifice_conductance` it is the law of Borutzky et al.;
    with a gap's conductance it is the gap with loss of the exit's kinetic energy. Validity:
    quasi-steady flow of one density; inertia of the fluid column is left out.

    References
    ----------
    .. [1] W. Borutzky, B. Barnard, J. Thoma, "An orifice flow model for laminar and turbulent
       conditions", Simulation Modelling Practice and Theory 10, 2002, 141-152.

    Examples
    --------
    A gap of 1e-13 m3/(s Pa) at 100 bar without kinetic loss:

    >>> flow = inertial_laminar_flow(100e5, 1e-13, float("inf"), 850.0)[0]
    >>> round(float(flow) * 6e4, 3)  # L/min
    0.06
    """
    ratio = laminar_conductance / np.maximum(discharge_area, 1e-300)
    root = np.sqrt(1.0 + 2.0 * density * ratio * ratio * np.abs(pressure_drop))
    inverse = 1.0 / (root * (1.0 + root))  # one division serves all three results
    per_conductance = 2.0 * pressure_drop * root * inverse
    by_pressure = laminar_conductance * (1.0 + root) * inverse
    return laminar_conductance * per_conductance, by_pressure, 2.0 * pressure_drop * inverse


@inlined
def inertial_laminar_drop(
    flow_rate: Any, laminar_conductance: Any, discharge_area: Any, density: Any
) -> Any:
    r"""Pressure drop of any path at its flow rate, the inverse of :func:`inertial_laminar_flow`.

    Parameters
    ----------
    flow_rate : float or ndarray
        Volumetric flow rate, positive towards downstream. [m3/s]
    laminar_conductance : float or ndarray
        Flow rate per pressure drop in creeping flow, positive. [m3/(s Pa)]
    discharge_area : float or ndarray
        Discharge coefficient times area; infinite for no kinetic loss. [m2]
    density : float or ndarray
        Density of the fluid in the path. [kg/m3]

    Returns
    -------
    pressure_drop : float or ndarray
        Upstream minus downstream pressure. [Pa]
    pressure_drop_by_flow_rate : float or ndarray
        Derivative with respect to the flow rate. [Pa s/m3]

    Notes
    -----
    .. math:: \Delta p = \frac{Q}{G} + \frac{\rho}{2 A_d^2} Q |Q|

    Validity: as there.

    References
    ----------
    .. [1] W. Borutzky, B. Barnard, J. Thoma, "An orifice flow model for laminar and turbulent
       conditions", Simulation Modelling Practice and Theory 10, 2002, 141-152.

    Examples
    --------
    >>> drop, _ = inertial_laminar_drop(1e-6, 1e-13, float("inf"), 850.0)
    >>> round(drop / 1e5, 6)  # bar
    100.0
    """
    kinetic = 0.5 * density / (discharge_area * discharge_area) * np.abs(flow_rate)
    return (
        flow_rate / laminar_conductance + kinetic * flow_rate,
        1.0 / laminar_conductance + 2.0 * kinetic,
    )


@inlined
def orifice_conductance(
    area: Any,
    hydraulic_diameter: Any,
    dynamic_viscosity: Any,
    discharge_coefficient: Any = DISCHARGE_COEFFICIENT,
    transition_reynolds_number: Any = TRANSITION_REYNOLDS_NUMBER,
) -> Any:
    r"""Conductance of an opening in creeping flow.

    Parameters
    ----------
    area : float or ndarray
        Area of the opening. [m2]
    hydraulic_diameter : float or ndarray
        Four times the area over the wetted perimeter. [m]
    dynamic_viscosity : float or ndarray
        Dynamic viscosity. [Pa s]
    discharge_coefficient : float or ndarray
        Discharge coefficient at high Reynolds number, 0.6 to 0.75. [-]
    transition_reynolds_number : float or ndarray
        Reynolds number at which laminar and kinetic loss are equal. [-]

    Returns
    -------
    float or ndarray
        Flow rate per pressure drop. [m3/(s Pa)]

    Notes
    -----
    From :math:`\Delta p = \rho (v^2 + v v_t) / (2 C^2)` with
    :math:`v_t = Re_t \nu / D_h` and :math:`Q = A v`,

    .. math:: G = \frac{2 C^2 A D_h}{\mu\, Re_t} .

    Validity: short openings; a gap longer than a few heights has its own conductance.

    References
    ----------
    .. [1] W. Borutzky, B. Barnard, J. Thoma, "An orifice flow model for laminar and turbulent
       conditions", Simulation Modelling Practice and Theory 10, 2002, 141-152.

    Examples
    --------
    A groove of 4 mm2 and 2 mm hydraulic diameter at 10 bar, oil of 26 mPa s:

    >>> conductance = orifice_conductance(4e-6, 2e-3, 0.026)
    >>> flow = inertial_laminar_flow(10e5, conductance, 0.7 * 4e-6, 842.0)[0]
    >>> round(float(flow) * 6e4, 2)  # L/min
    8.12
    """
    numerator = 2.0 * discharge_coefficient * discharge_coefficient * area * hydraulic_diameter
    return numerator / (dynamic_viscosity * transition_reynolds_number)
