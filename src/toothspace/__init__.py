"""Simulator of hydraulic gear machines: external and internal gear pumps and motors, gerotors.

>>> import toothspace as ts
>>> case = ts.load_case("cases/egm12_motor.toml")  # doctest: +SKIP
>>> solution = ts.simulate(case)  # doctest: +SKIP
>>> solution.summary()["volumetric_efficiency"]  # doctest: +SKIP

Names are declared once, in ``__init__.pyi``, and imported on first use, so that the command line
answers at once.
"""

from functools import cache

import lazy_loader

_attached, __dir__, _names = lazy_loader.attach_stub(__name__, __file__)
__all__ = [*_names, "__version__"]


def __getattr__(name: str) -> object:
    """Import a public name on first use."""
    return _version() if name == "__version__" else _attached(name)


@cache
def _version() -> str:
    from importlib.metadata import PackageNotFoundError, version

    try:
        return version("toothspace")
    except PackageNotFoundError:
        return "0+not.installed"
