"""Pictures of the studies of the floating bearing.

Run ``python docs/pictures/bearing_studies.py`` where ``toothspace study`` has left the folders
``hysteresis_055_study``, ``hysteresis_078_study``, ``hysteresis_overlay_study``,
``balance_sweep_study`` and ``bearing_map_study`` of the cases.
"""

from __future__ import annotations

from pathlib import Path

import matplotlib as mpl
import xarray as xr

from toothspace.plotting.style import save_figure
from toothspace.studies import study_figures

HERE = Path(__file__).resolve().parent
PICTURES = (
    ("hysteresis_055", "hysteresis", "positions", "hysteresis_loops"),
    ("hysteresis_055", "hysteresis", "film_height", "hysteresis_films"),
    ("hysteresis_078", "hysteresis", "wear", "lateral_wear"),
    ("hysteresis_overlay", "hysteresis", "positions", "hysteresis_overlay"),
    ("balance_sweep", "balance_sweep", "area_sensitivity", "area_sensitivity"),
    ("balance_sweep", "balance_sweep", "friction_sensitivity", "friction_sensitivity"),
    ("bearing_map", "bearing_map", "bearing_map", "bearing_map"),
)

if __name__ == "__main__":
    mpl.use("Agg")
    for case, kind, figure, picture in PICTURES:
        with xr.open_dataset(Path(f"{case}_study") / "study.nc") as data:
            found = {f.name: f.figure for f in study_figures(kind, data.load())}
        save_figure(found[figure], HERE / f"{picture}.png")
