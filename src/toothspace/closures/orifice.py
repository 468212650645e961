"""Flow through openings: one law from creeping flow to jets, and two laws to compare with."""

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
    with a gap's conductance it is the gap with loss of the exit's kinetic energy.

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

    References
    ----------
    .. [1] W. Borutzky, B. Barnard, J. Thoma, "An orifice flow model for laminar and turbulent
       conditions", Simulation Modelling Practice and Theory 10, 2002, 141-152.
    """
    numerator = 2.0 * discharge_coefficient * discharge_coefficient * area * hydraulic_diameter
    return numerator / (dynamic_viscosity * transition_reynolds_number)


@inlined
def orifice_flow_rate(
    pressure_drop: Any,
    area: Any,
    hydraulic_diameter: Any,
    density: Any,
    dynamic_viscosity: Any,
    discharge_coefficient: Any = DISCHARGE_COEFFICIENT,
    transition_reynolds_number: Any = TRANSITION_REYNOLDS_NUMBER,
) -> Any:
    r"""Flow rate through an opening, laminar at the start and turbulent at the end.

    Parameters
    ----------
    pressure_drop : float or ndarray
        Upstream minus downstream pressure. [Pa]
    area : float or ndarray
        Area of the opening. [m2]
    hydraulic_diameter : float or ndarray
        Four times the area over the wetted perimeter. [m]
    density : float or ndarray
        Density. [kg/m3]
    dynamic_viscosity : float or ndarray
        Dynamic viscosity. [Pa s]
    discharge_coefficient : float or ndarray
        Discharge coefficient at high Reynolds number. [-]
    transition_reynolds_number : float or ndarray
        Reynolds number at which laminar and kinetic loss are equal. [-]

    Returns
    -------
    float or ndarray
        Volumetric flow rate, positive towards downstream. [m3/s]

    Notes
    -----
    .. math:: Q = \mathrm{sign}(\Delta p) \frac{A v_t}{2}
        \left(\sqrt{1 + \frac{8 C^2 |\Delta p|}{\rho v_t^2}} - 1\right),
        \quad v_t = \frac{Re_t \mu}{\rho D_h}

    References
    ----------
    .. [1] W. Borutzky, B. Barnard, J. Thoma, "An orifice flow model for laminar and turbulent
       conditions", Simulation Modelling Practice and Theory 10, 2002, 141-152.

    Examples
    --------
    A groove of 4 mm2 and 2 mm hydraulic diameter at 10 bar, oil of 26 mPa s:

    >>> round(float(orifice_flow_rate(10e5, 4e-6, 2e-3, 842.0, 0.026)) * 6e4, 2)  # L/min
    8.12
    """
    conductance = orifice_conductance(
        area,
        hydraulic_diameter,
        dynamic_viscosity,
        discharge_coefficient,
        transition_reynolds_number,
    )
    return inertial_laminar_flow(pressure_drop, conductance, discharge_coefficient * area, density)[
        0
    ]


@inlined
def orifice_flow_rate_tanh(
    pressure_drop: Any,
    area: Any,
    hydraulic_diameter: Any,
    density: Any,
    dynamic_viscosity: Any,
    discharge_coefficient: Any = DISCHARGE_COEFFICIENT,
    critical_flow_number: Any = 1000.0,
) -> Any:
    r"""Flow rate through an opening with a discharge coefficient that grows as tanh.

    Parameters
    ----------
    pressure_drop : float or ndarray
        Upstream minus downstream pressure. [Pa]
    area : float or ndarray
        Area of the opening. [m2]
    hydraulic_diameter : float or ndarray
        Four times the area over the wetted perimeter. [m]
    density : float or ndarray
        Density. [kg/m3]
    dynamic_viscosity : float or ndarray
        Dynamic viscosity. [Pa s]
    discharge_coefficient : float or ndarray
        Largest discharge coefficient. [-]
    critical_flow_number : float or ndarray
        Flow number of the transition: 100 to 200 sharp and thin, to 2000 smooth. [-]

    Returns
    -------
    float or ndarray
        Volumetric flow rate, positive towards downstream. [m3/s]

    Notes
    -----
    .. math:: Q = C \tanh\!\left(\frac{2 \lambda}{\lambda_{crit}}\right) A
        \sqrt{\frac{2 |\Delta p|}{\rho}}\, \mathrm{sign}(\Delta p), \quad
        \lambda = \frac{D_h}{\nu} \sqrt{\frac{2 |\Delta p|}{\rho}}

    Defaults as in common circuit simulators. For comparison only.
    """
    speed = np.sqrt(2.0 * np.abs(pressure_drop) / density)
    flow_number = hydraulic_diameter * density / dynamic_viscosity * speed
    coefficient = discharge_coefficient * np.tanh(2.0 * flow_number / critical_flow_number)
    return coefficient * area * speed * np.sign(pressure_drop)


@inlined
def orifice_flow_rate_root(
    pressure_drop: Any,
    area: Any,
    hydraulic_diameter: Any,
    density: Any,
    dynamic_viscosity: Any,
    discharge_coefficient: Any = 0.7,
    critical_reynolds_number: Any = 12.0,
) -> Any:
    r"""Flow rate through an opening with a rounded square root.

    Parameters
    ----------
    pressure_drop : float or ndarray
        Upstream minus downstream pressure. [Pa]
    area : float or ndarray
        Area of the opening. [m2]
    hydraulic_diameter : float or ndarray
        Four times the area over the wetted perimeter. [m]
    density : float or ndarray
        Density. [kg/m3]
    dynamic_viscosity : float or ndarray
        Dynamic viscosity. [Pa s]
    discharge_coefficient : float or ndarray
        Discharge coefficient. [-]
    critical_reynolds_number : float or ndarray
        Reynolds number of the transition. [-]

    Returns
    -------
    float or ndarray
        Volumetric flow rate, positive towards downstream. [m3/s]

    Notes
    -----
    .. math:: Q = C A \sqrt{\frac{2}{\rho}}
        \frac{\Delta p}{(\Delta p^2 + p_{cr}^2)^{1/4}}, \quad
        p_{cr} = \frac{\rho}{2} \left(\frac{Re_{cr} \nu}{C D_h}\right)^2

    For comparison only.

    References
    ----------
    .. [1] MathWorks, Simscape Fluids reference, *Orifice*.
    """
    speed = critical_reynolds_number * dynamic_viscosity / density
    speed = speed / (discharge_coefficient * hydraulic_diameter)
    critical = 0.5 * density * speed * speed
    root = np.sqrt(np.sqrt(pressure_drop * pressure_drop + critical * critical))
    return discharge_coefficient * area * np.sqrt(2.0 / density) * pressure_drop / root
