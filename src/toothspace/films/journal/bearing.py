"""Journal bearing with mass-conserving cavitation: forces, flows, friction, equilibrium."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.films.journal.equilibrium import find_equilibrium, find_tilted_equilibrium
from toothspace.films.journal.geometry import JournalDefinition, MotionState, SurfaceSpeed
from toothspace.films.journal.solution import JournalBearingSolution, solve_motion
from toothspace.films.reynolds.rough_surfaces import refuse_deep_contact
from toothspace.films.reynolds.state import FilmHistory

Pair = tuple[float, float]


@final
@dataclass(frozen=True, kw_only=True)
class JournalBearing(JournalDefinition):
    r"""Film between a rigid shaft and a rigid cylindrical bush.

    Parameters
    ----------
    diameter : float
        Bore of the bush. [m]
    length : float
        Axial length of the film. [m]
    radial_clearance : float
        Radius of the bush minus radius of the shaft. [m]
    dynamic_viscosity : float
        Dynamic viscosity. [Pa s]
    grid : tuple of int
        Cells round the circumference and along the axis. [-]
    cavitation : {"jfo", "reynolds", "guembel"}
        Mass-conserving film fraction, pressure obstacle, or clipped pressure.
    grooves : tuple of Groove
        Grooves of given pressure in the bush.
    end_pressure : float
        Absolute pressure beyond both ends. [Pa]
    cavitation_pressure : float
        Absolute pressure in the cavity. [Pa]
    end_condition : {"pressure", "no_flow"}
        Whether the ends are open or walls.
    surfaces : RoughSurfaces, optional
        Roughness and contact; the shaft is the moving wall. Smooth walls if not given.
    lobes : Lobes, optional
        Bore of lobes; the radial clearance is then that of each lobe's own circle.
    pressure_viscosity : float
        Coefficient of Barus, of mu exp(alpha p). [1/Pa]
    compressible : bool
        Whether the density follows the pressure after Dowson and Higginson.
    supply : {"auto", "none", "widest_gap"}
        Ideal axial supply line at end pressure on the widest gap. ``auto`` adds it where oil
        could not enter otherwise: no grooves, and ends not above the cavitation pressure.

    Notes
    -----
    Angles run from x towards y, the direction of positive ``shaft_speed``. Forces act on
    the shaft by the film. With a film fraction :math:`s` the flow is

    .. math::

        \nabla\cdot\left(-\frac{h^3}{12\mu}\nabla p + s h \frac{\omega R}{2}\mathbf e
        \right) + s\,\frac{\partial h}{\partial t} = 0, \quad
        p \ge p_c,\ s \le 1,\ (p - p_c)(1 - s) = 0 .

    Validity: laminar, no inertia, :math:`c \ll R`; the film fraction follows the motion of the
    shaft without delay. Stiffness and damping hold the density; flows count at the density of
    zero pressure.

    References
    ----------
    .. [1] H. G. Elrod, A cavitation algorithm, J. Lubr. Technol. 103 (1981) 350-354.

    Examples
    --------
    >>> from math import pi
    >>> bearing = JournalBearing(
    ...     diameter=0.1, length=0.08, radial_clearance=150e-6, dynamic_viscosity=0.01
    ... )
    >>> film = bearing.solve(eccentricity=(0.6, 0.0), shaft_speed=100.0 * pi)
    >>> round(film.attitude_angle * 180.0 / pi)
    50
    """

    def solve(
        self,
        *,
        eccentricity: Pair = (0.0, 0.0),
        shaft_speed: float,
        velocity: Pair = (0.0, 0.0),
        tilt: Pair = (0.0, 0.0),
        tilt_rate: Pair = (0.0, 0.0),
        bush_speed: float = 0.0,
        history: FilmHistory | None = None,
    ) -> JournalBearingSolution:
        """Film for a given position and motion of the shaft.

        Parameters
        ----------
        eccentricity : tuple of float
            Displacement x, y of the shaft over the radial clearance. [-]
        shaft_speed : float
            Rotation of the shaft, positive from x towards y. [rad/s]
        velocity : tuple of float
            Velocity x, y of the shaft axis. [m/s]
        tilt : tuple of float
            Rotation of the shaft about the x and y axis, right-handed. [rad]
        tilt_rate : tuple of float
            Time derivative of the tilt. [rad/s]
        bush_speed : float
            Rotation of the bush; grooves stay where they are. [rad/s]
        history : FilmHistory, optional
            ``solution.history(time_step)`` of the film one time step ago: the liquid is then
            followed in time and the velocity is that of the two positions.

        Returns
        -------
        JournalBearingSolution
            Pressure, film fraction and everything derived from them.

        Raises
        ------
        CaseError
            If shaft and bush touch.
        """
        for name, pair in (("eccentricity", eccentricity), ("velocity", velocity), ("tilt", tilt)):
            if np.shape(pair) != (2,):
                raise CaseError(f"bearing.{name}", f"{pair!r}", "two numbers, x and y")
        place = np.array([*(self.radial_clearance * np.asarray(eccentricity, float)), *tilt])
        motion = MotionState(place, np.array([*velocity, *tilt_rate], dtype=float))
        speed = SurfaceSpeed(shaft_speed, bush_speed)
        film = solve_motion(self, motion, speed, history=history)
        refuse_deep_contact(film.solved.film.gap.centre, self.surfaces, "bearing.eccentricity")
        return film

    def equilibrium(
        self,
        *,
        load: Pair,
        shaft_speed: float,
        start: Pair | None = None,
        bush_speed: float = 0.0,
        moment: Pair | None = None,
    ) -> JournalBearingSolution:
        """Steady position of the shaft under a load.

        Parameters
        ----------
        load : tuple of float
            External force x, y on the shaft. [N]
        shaft_speed : float
            Rotation of the shaft, positive from x towards y. [rad/s]
        start : tuple of float, optional
            Eccentricity to begin with. [-]
        bush_speed : float
            Rotation of the bush. [rad/s]
        moment : tuple of float, optional
            External moment about x and y on the shaft, which is then free to tilt; without it
            the shaft stays parallel to the bush. [N m]

        Returns
        -------
        JournalBearingSolution
            Film in equilibrium; ``status`` says whether it was found.
        """
        speed = SurfaceSpeed(shaft_speed, bush_speed)
        force = np.asarray(load, dtype=float)
        if moment is None:
            return find_equilibrium(self, force, speed, start)
        return find_tilted_equilibrium(self, force, np.asarray(moment, float), speed, start)
