"""Pictures of runs and studies of shipped cases, for README, gallery and tutorials.

Run ``python docs/pictures/runs.py FOLDER`` from the root of the repository. What FOLDER lacks is
left out:

=================== ======================================================================
``pump.nc``         run of ``egm12_pump``
``startup.nc``      run of ``startup_fan_drive``
``gerotor.nc``      run of ``gerotor_cycloidal``
``floating.nc``     run of ``point.toml`` of the tutorial on floating bearings
``map/``            study ``efficiency_map_egm12``
``ratio/``          study ``startup_ratio``
``span/``           study ``contact_span``
``wear/``           study ``wear_egm12_pump``
``noise/``          study ``noise_comparison``
``robust/``         study ``quiet_pump_robust``
=================== ======================================================================
"""

from __future__ import annotations

import io
import sys
from pathlib import Path

import matplotlib as mpl
import numpy as np
import xarray as xr
from PIL import Image

import toothspace as ts
from toothspace.plotting.section import gear_section
from toothspace.plotting.style import save_figure
from toothspace.studies import study_figures

HERE = Path(__file__).resolve().parent
FRAMES = 20
FIGURES = {
    "pump": {
        "gear_section": "gear_section",
        "chamber_pressure": "pump_pressure",
        "loss_bars": "pump_losses",
        "leakage_by_path": "pump_leakage",
        "journal_orbits": "pump_orbits",
    },
    "startup": {"speed_and_pressure": "startup_cycle", "breakaway_zoom": "startup_breakaway"},
    "floating": {"lateral_films": "floating_films"},
    "gerotor": {
        "gear_section": "gerotor_section",
        "pocket_cycle": "gerotor_pocket",
        "tooth_contact_forces": "gerotor_forces",
        "torque_ripple": "gerotor_torque",
    },
}
STUDIES = {
    "map": ("efficiency_map", "efficiency_map", "efficiency_map"),
    "ratio": ("startup", "startup_ratio", "startup_ratio"),
    "span": ("contact_span", "contact_span", "contact_span"),
    "wear": ("wear", "wear", "wear"),
    "noise": ("noise", "noise", "noise"),
    "robust": ("optimise", "search", "robust_search"),
}


def turning_pump(solution: ts.Solution, file: Path) -> None:
    """One tooth pitch as a moving picture that closes on itself."""
    frames = []
    for fraction in np.arange(FRAMES) / FRAMES:
        page = io.BytesIO()
        figure = gear_section(solution, solution.description, (float(fraction),))
        figure.savefig(page, dpi=80, format="png")
        image = Image.open(page).convert("RGB")
        frames.append(image.quantize(64, dither=Image.Dither.NONE))
    rest = {"save_all": True, "append_images": frames[1:], "duration": 80, "loop": 0}
    frames[0].save(file, optimize=True, **rest)


def main(folder: Path) -> None:
    """Draw what the results in a folder give."""
    for run, wanted in FIGURES.items():
        if (folder / f"{run}.nc").is_file():
            solution = ts.load_solution(folder / f"{run}.nc")
            for name, picture in wanted.items():
                save_figure(solution.plot.figure(name), HERE / f"{picture}.png")
            if run == "pump":
                turning_pump(solution, HERE / "gear_section.gif")
    for study, (kind, name, picture) in STUDIES.items():
        if (folder / study / "study.nc").is_file():
            with xr.open_dataset(folder / study / "study.nc") as data:
                found = {f.name: f.figure for f in study_figures(kind, data.load())}
            save_figure(found[name], HERE / f"{picture}.png")


if __name__ == "__main__":
    mpl.use("Agg")
    main(Path(sys.argv[1]))
