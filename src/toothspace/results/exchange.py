"""Results for other programs: a dataset as MAT file of MATLAB and Octave."""

from __future__ import annotations

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    import xarray as xr

_LONGEST_NAME = 63
"""Characters of a name in MATLAB."""


def write_mat(data: xr.Dataset, path: Path) -> Path:
    """Write all variables of a result under their names as a MAT file (version 5).

    ``units`` and ``dimensions`` are structures with a text for each variable; text variables are
    cell arrays. Characters that MATLAB allows in no name become underscores.

    Parameters
    ----------
    data : xarray.Dataset
        Data of a solution or study.
    path : Path
        File to write.
    """
    from scipy.io import savemat

    content: dict[str, Any] = {}
    units: dict[str, str] = {}
    dimensions: dict[str, str] = {}
    for given, variable in data.variables.items():
        name = re.sub(r"\W", "_", str(given))[:_LONGEST_NAME]
        values = np.asarray(variable.values)
        content[name] = values if values.dtype.kind in "fiub" else values.astype(object)
        units[name] = str(variable.attrs.get("units", "1"))
        dimensions[name] = " ".join(map(str, variable.dims))
    savemat(
        path,
        {**content, "units": units, "dimensions": dimensions},
        appendmat=False,
        long_field_names=True,
        do_compression=True,
        oned_as="column",
    )
    return path
