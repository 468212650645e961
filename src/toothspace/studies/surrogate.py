"""Surrogates: smooth functions through the points of a finished study, with error bars."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.files import write_text
from toothspace.core.keys import suggestion
from toothspace.core.netcdf import read_dataset
from toothspace.core.types import Array
from toothspace.core.units import compatible, is_quantity, split_quantity
from toothspace.plotting.style import MAIN_NUMBERS
from toothspace.studies.variation import number_in

if TYPE_CHECKING:
    import xarray as xr

_FOLDS = 10
_FORMAT = "toothspace surrogate 1"
_FEWEST = 6


@final
@dataclass(frozen=True)
class GaussianProcess:
    r"""One number as a Gaussian process over varied keys.

    Notes
    -----
    With keys scaled to the unit cube and the number scaled to mean 0 and deviation 1,

    .. math:: k(x, x') = c\,M_{5/2}(r) + \nu\,\delta_{xx'},\qquad
              r^2 = \sum_j (x_j - x'_j)^2 / l_j^2

    .. math:: M_{5/2}(r) = (1 + \sqrt5 r + \tfrac53 r^2)\, e^{-\sqrt5 r}

    .. math:: m(x) = k_x^T K^{-1} y,\qquad s^2(x) = c - k_x^T K^{-1} k_x

    The noise is left out of the deviation: that of a computed number is what the process does
    not resolve, and the hold-out error tells of it.

    References
    ----------
    .. [1] C. E. Rasmussen, C. K. I. Williams, Gaussian Processes for Machine Learning, MIT Press,
       2006, algorithm 2.1.
    """

    points: Array
    """Points of the study in the unit cube, shape (points, keys). [-]"""
    values: Array
    """Their numbers, scaled. [-]"""
    mean: float
    deviation: float
    """Of the numbers. [unit of the number]"""
    variance: float
    """Factor :math:`c` of the covariance. [-]"""
    lengths: Array
    """Lengths :math:`l_j` over which the number changes. [-]"""
    noise: float
    """Variance :math:`\\nu` of what is not resolved. [-]"""
    hold_out_error: float
    """Root mean square error at points that the fit had not seen. [unit of the number]"""

    def covariance(self, first: Array, second: Array) -> Array:
        """Covariance of scaled numbers between points, shape (first, second). [-]."""
        apart = (first[:, None, :] - second[None, :, :]) / self.lengths
        root = np.sqrt(5.0 * np.sum(apart**2, axis=2))
        return np.asarray(self.variance * (1.0 + root + root**2 / 3.0) * np.exp(-root))

    @cached_property
    def _factor(self) -> Any:
        from scipy.linalg import cho_factor

        own = self.covariance(self.points, self.points)
        return cho_factor(own + self.noise * np.eye(len(own)), lower=True)

    def predict(self, shares: Array) -> tuple[Array, Array]:
        """Mean and standard deviation at points of the unit cube. [unit of the number]."""
        from scipy.linalg import cho_solve

        factor = self._factor
        across = self.covariance(shares, self.points)
        mean = across @ cho_solve(factor, self.values)
        explained = np.sum(across * cho_solve(factor, across.T).T, axis=1)
        spread = np.sqrt(np.maximum(self.variance - explained, 0.0))
        return self.mean + self.deviation * mean, self.deviation * spread


def fit_process(points: Array, numbers: Array, seed: int = 0) -> GaussianProcess:
    """Fit a Gaussian process by the likelihood of its points, with its hold-out error.

    Parameters
    ----------
    points : ndarray, shape (points, keys)
        Points of the unit cube. [-]
    numbers : ndarray, shape (points,)
        Finite numbers there. [any]

    Notes
    -----
    The error is that of ten parts of the points, each predicted from the nine others with
    covariances of the whole fit; of every point alone where there are fewer than twenty.

    Raises
    ------
    CaseError
        If scikit-learn is missing.
    """
    try:
        from sklearn.exceptions import ConvergenceWarning
        from sklearn.gaussian_process import GaussianProcessRegressor
        from sklearn.gaussian_process.kernels import ConstantKernel, Matern, WhiteKernel
    except ImportError as error:
        found = "no package scikit-learn"
        raise CaseError("surrogate", found, 'after pip install "toothspace[design]"') from error
    import warnings

    mean, deviation = float(np.mean(numbers)), float(np.std(numbers))
    keys = points.shape[1]
    if deviation == 0.0:
        return GaussianProcess(points, numbers * 0.0, mean, 0.0, 1.0, np.ones(keys), 1e-10, 0.0)
    scaled = (numbers - mean) / deviation
    kernel = ConstantKernel(1.0, (1e-2, 1e4)) * Matern(np.full(keys, 0.5), (0.05, 50.0), nu=2.5)
    kernel += WhiteKernel(1e-4, (1e-10, 1.0))
    from threadpoolctl import threadpool_limits

    # many small matrices: more threads only wait for one another
    with warnings.catch_warnings(), threadpool_limits(1):
        # a key that does nothing has no length: its bound is the answer
        warnings.simplefilter("ignore", ConvergenceWarning)
        fitted = GaussianProcessRegressor(kernel, random_state=seed).fit(points, scaled)
    found = fitted.kernel_
    process = GaussianProcess(
        points,
        scaled,
        mean,
        deviation,
        float(found.k1.k1.constant_value),
        np.broadcast_to(np.asarray(found.k1.k2.length_scale, dtype=float), (keys,)).copy(),
        float(found.k2.noise_level),
        0.0,
    )
    return _with_error(process, seed)


def _with_error(process: GaussianProcess, seed: int) -> GaussianProcess:
    count = len(process.points)
    parts = np.array_split(
        np.random.default_rng(seed).permutation(count), count if count < 2 * _FOLDS else _FOLDS
    )
    off = np.empty(count)
    for part in parts:
        rest = np.setdiff1d(np.arange(count), part)
        one = replace(process, points=process.points[rest], values=process.values[rest])
        predicted, _ = one.predict(process.points[part])
        off[part] = predicted - (process.mean + process.deviation * process.values[part])
    return replace(process, hold_out_error=float(np.sqrt(np.mean(off**2))))


@final
@dataclass(frozen=True)
class Surrogate:
    """Numbers of a study as functions of its varied keys."""

    keys: tuple[str, ...]
    """Paths of the varied keys."""
    units: tuple[str, ...]
    """Their units, ``1`` without one."""
    low: Array
    high: Array
    """Smallest and largest value of each key among the points. [unit of the key]"""
    processes: Mapping[str, GaussianProcess]
    """Process of each number."""

    def __repr__(self) -> str:
        points = len(next(iter(self.processes.values())).points)
        names = ", ".join(self.processes)
        return f"<Surrogate of {names} over {len(self.keys)} keys, {points} points>"

    def shares(self, values: Mapping[str, Any]) -> Array:
        """Values of all keys as points of the unit cube, shape (points, keys). [-].

        Raises CaseError if a key is missing, unknown, or out of the range of the points.
        """
        for path in values:
            if path not in self.keys:
                raise CaseError("surrogate", f"{path!r}", suggestion(path, self.keys))
        columns = []
        for path, unit, low, high in zip(self.keys, self.units, self.low, self.high, strict=True):
            if path not in values:
                raise CaseError("surrogate", f"no value of {path}", "a value of each varied key")
            column = np.array([_in_unit(x, unit) for x in np.atleast_1d(values[path])])
            slack = 1e-9 * (high - low)
            if (column < low - slack).any() or (column > high + slack).any():
                span = f"{low:g} to {high:g} {'' if unit == '1' else unit}".strip()
                raise CaseError(
                    path, f"{values[path]!r}", f"values from {span}, those of the study"
                )
            columns.append((column - low) / (high - low))
        return np.column_stack(np.broadcast_arrays(*columns))

    def predict(self, values: Mapping[str, Any]) -> xr.Dataset:
        """Predict all numbers with error bars.

        Parameters
        ----------
        values : mapping of key path to value or list
            A value of each varied key: a text with unit, or a number in the unit of the study.

        Returns
        -------
        xarray.Dataset
            Over ``point``: each number, ``<number>_deviation``, the standard deviation of the
            process there, and as attribute ``hold_out_error``. [unit of the number]
        """
        import xarray as xr

        shares = self.shares(values)
        found: dict[str, Any] = {}
        for name, process in self.processes.items():
            mean, spread = process.predict(shares)
            found[name] = ("point", mean, {"hold_out_error": process.hold_out_error})
            found[f"{name}_deviation"] = ("point", spread)
        return xr.Dataset(found)

    def save(self, path: str | Path) -> Path:
        """Write all there is to it as JSON; returns the path."""
        content = {
            "format": _FORMAT,
            "keys": self.keys,
            "units": self.units,
            "low": self.low.tolist(),
            "high": self.high.tolist(),
            "processes": {
                name: {
                    one.name: np.asarray(getattr(process, one.name)).tolist()
                    for one in fields(process)
                }
                for name, process in self.processes.items()
            },
        }
        return write_text(Path(path), json.dumps(content) + "\n")


def load_surrogate(path: str | Path) -> Surrogate:
    """Read a surrogate that :meth:`Surrogate.save` wrote.

    Raises CaseError if the file holds none.
    """
    try:
        content = json.loads(Path(path).read_text(encoding="utf-8"))
        if content.pop("format") != _FORMAT:
            raise ValueError
        processes = {
            name: GaussianProcess(**{k: _array(v) for k, v in given.items()})
            for name, given in content["processes"].items()
        }
        keys, units = tuple(content["keys"]), tuple(content["units"])
        low, high = np.array(content["low"]), np.array(content["high"])
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise CaseError(str(path), "no surrogate", "a file of Surrogate.save") from error
    return Surrogate(keys, units, low, high, processes)


def fit_surrogate(study: str | Path | xr.Dataset, names: Sequence[str] = ()) -> Surrogate:
    """Fit the numbers of a finished study over its varied keys.

    Parameters
    ----------
    study : str, Path or xarray.Dataset
        Folder of a study, its ``study.nc``, or ``result.data`` of a sweep, tolerance, optimise or
        pareto study.
    names : sequence of str
        Numbers to fit; main numbers if left out.

    Raises
    ------
    CaseError
        If the study has no varied keys, too few points, or no such number, or if scikit-learn is
        missing.

    Examples
    --------
    >>> import toothspace as ts
    >>> surrogate = ts.fit_surrogate("clearances", ["volumetric_efficiency"])  # doctest: +SKIP
    >>> surrogate.predict({"machine.lateral.side_gap": "8 um"})  # doctest: +SKIP
    """
    data = study
    if isinstance(data, str | Path):
        path = Path(data)
        path = path / "study.nc" if path.is_dir() else path
        data = read_dataset(path, "the folder of a finished study, or its study.nc")
    keys = tuple(
        str(name)
        for name in data.variables
        if "." in str(name) and data[name].dtype.kind in "iuf" and np.ptp(data[name].values) > 0.0
    )
    if not keys:
        raise CaseError("surrogate", "no varied keys", "a study that varies keys")
    numbers = [str(n) for n in data.data_vars if data[n].dtype.kind == "f" and "." not in str(n)]
    chosen = tuple(names) or tuple(n for n in MAIN_NUMBERS if n in numbers) or tuple(numbers[:6])
    for name in chosen:
        if name not in numbers:
            raise CaseError("surrogate", f"{name!r}", suggestion(name, numbers))
    like = data[chosen[0]]
    columns = [data[key].broadcast_like(like).transpose(*like.dims).values for key in keys]
    table = np.column_stack([column.ravel() for column in columns]).astype(float)
    low, high = table.min(axis=0), table.max(axis=0)
    shares = (table - low) / (high - low)
    processes = {}
    for name in chosen:
        values = data[name].values.ravel()
        known = np.isfinite(values)
        if known.sum() < _FEWEST:
            found = f"{known.sum()} points with {name}"
            raise CaseError("surrogate", found, f"at least {_FEWEST}")
        processes[name] = fit_process(shares[known], values[known])
    units = tuple(str(data[key].attrs.get("units", "1")) for key in keys)
    return Surrogate(keys, units, low, high, processes)


def _array(value: Any) -> Any:
    return np.array(value) if isinstance(value, list) else value


def _in_unit(value: Any, unit: str) -> float:
    """Number of a value in the unit of a key."""
    if is_quantity(value) and not compatible(split_quantity(value)[1], unit):
        raise CaseError("surrogate", f"{value!r}", f"a value in {unit}")
    return number_in(value, unit)
