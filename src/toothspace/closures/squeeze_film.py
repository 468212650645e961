"""Film squeezed out of a line contact, for compiled code."""

from __future__ import annotations

import numpy as np

from toothspace.core.compiled import inlined

REACH = 60.0
"""Gap at which the film begins to resist, over the roughness. [-]"""

_FORCE = 3.0 * np.sqrt(2.0) * np.pi


@inlined
def squeeze_damping(
    gap: float, roughness: float, curvature: float, viscosity: float
) -> tuple[float, float]:
    r"""Force per length and speed at which two cylinders approach in a liquid.

    Parameters
    ----------
    gap : float
        Gap of the mean surfaces, negative while they overlap. [m]
    roughness : float
        Combined root mean square roughness: the valleys hold a film that is never squeezed
        out. [m]
    curvature : float
        Relative curvature. [1/m]
    viscosity : float
        Dynamic viscosity. [Pa s]

    Returns
    -------
    damping : float
        Line load over the speed of approach; zero from :data:`REACH` roughness heights on.
        [N s/m2]
    by_gap : float
        Its derivative. [N s/m3]

    Notes
    -----
    Validity: rigid parabolic surfaces, isoviscous, full film.

    .. math::

        \frac{q}{v} = 3\sqrt2\,\pi\,\mu \left(\frac{R}{h}\right)^{3/2}, \qquad
        h = \sigma + \tfrac12\left(g + \sqrt{g^2 + \sigma^2}\right) .

    From :math:`\mathrm dp/\mathrm dx = 12\mu v x/h^3` with :math:`h = h_0 + x^2/2R`. A film
    that is drawn apart cavitates and does not pull: use it for approach only.

    References
    ----------
    .. [1] B. J. Hamrock, S. R. Schmid, B. O. Jacobson, Fundamentals of Fluid Film Lubrication,
       2nd ed., Marcel Dekker, 2004, chapter 11.
    """
    if gap >= REACH * roughness:
        return 0.0, 0.0
    root = np.sqrt(gap * gap + roughness * roughness)
    height = roughness + 0.5 * (gap + root)
    far = roughness * (1.0 + 0.5 * (REACH + np.sqrt(REACH * REACH + 1.0)))
    scale = _FORCE * viscosity / (curvature * np.sqrt(curvature))
    near = 1.0 / (height * np.sqrt(height))
    by_height = -1.5 * near / height
    return scale * (near - 1.0 / (far * np.sqrt(far))), scale * by_height * 0.5 * (1.0 + gap / root)
