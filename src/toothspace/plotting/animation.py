"""A machine that turns: its section coloured by pressure, as a moving picture."""

from __future__ import annotations

from importlib.util import find_spec
from pathlib import Path
from typing import Any

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.files import draft_of
from toothspace.core.processes import program_named
from toothspace.core.progress import Progress, part, tell
from toothspace.plotting.section import (
    HEIGHTS,
    draw_section,
    housing_region,
    section_at,
    top_of_scale,
)
from toothspace.plotting.style import GREY, ORANGE, PRESSURE_COLOURS, new_figure, styled
from toothspace.results.solution import Solution

ENDINGS = (".gif", ".mp4")
"""Formats by the ending of the file."""
_BAR = 1e5
_PER_SECOND = 12
_FRAMES = 36
"""Pictures of one pitch, after which the machine looks the same."""
_ARROW = 0.35
"""Length of the largest force over the height of the casing. [-]"""


def require_writer(path: Path) -> Any:
    """Return what writes a moving picture, before anything is computed for it.

    MP4 needs the program ``ffmpeg``, installed or brought by the package ``imageio-ffmpeg``.

    Raises
    ------
    CaseError
        If there is none.
    """
    from matplotlib.animation import FFMpegWriter, PillowWriter

    if path.suffix.lower() != ".mp4":
        return PillowWriter(_PER_SECOND)
    program = program_named("ffmpeg") or _brought_program()
    if program is None:
        allowed = "a .gif, or ffmpeg: of the system, or pip install 'toothspace[film]'"
        raise CaseError("-o", repr(path.name), allowed)
    import matplotlib as mpl

    mpl.rcParams["animation.ffmpeg_path"] = program
    return FFMpegWriter(_PER_SECOND)


def _brought_program() -> str | None:
    if find_spec("imageio_ffmpeg") is None:
        return None
    import imageio_ffmpeg

    return str(imageio_ffmpeg.get_ffmpeg_exe())


@styled
def write_animation(
    solution: Solution, path: Path, frames: int = _FRAMES, progress: Progress | None = None
) -> Path:
    """Write a machine turning through one pitch, over and over.

    Left the section with the pressures as colour and the pressure forces on the bodies as arrows,
    of teeth that wind at both ends and in the middle; right the pressure of one chamber over the
    turn with a cursor where it stands.

    Parameters
    ----------
    solution : Solution
        Result over the shaft angle.
    path : Path
        File; GIF or MP4 by its ending.
    frames : int
        Pictures of one pitch.
    progress : callable, optional
        Called with the finished share and a short text.

    Returns
    -------
    Path
        The file.

    Raises
    ------
    CaseError
        If the result is over time, its machine cannot be rebuilt, or the file cannot be made.
    """
    import matplotlib as mpl
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    description, data = solution.description, solution.data
    if "shaft_angle" not in data.sizes or "chamber_pressure" not in data:
        raise CaseError("result", "a run over time", "a run over the shaft angle with pressures")
    if description is None or section_at(description, 0.0, 0.0).drawn.chamber_outlines is None:
        raise CaseError("result", "a machine that cannot be drawn", "one whose files are there")
    final = path if path.suffix.lower() in ENDINGS else path.with_suffix(".gif")
    writer = require_writer(final)
    angle = np.asarray(data["shaft_angle"])
    pressure = np.asarray(data["chamber_pressure"])
    ports = {port: np.asarray(data[f"{port}_pressure"]) for port in ("inlet", "outlet")}
    forces = np.asarray(data["body_force"])[..., :2] if "body_force" in data else None
    left, low, right, high = housing_region(description).bounds
    heights = (0.0,) if description.winding is None else HEIGHTS
    wide = (4.6 if len(heights) == 1 else 3.0) * (right - left) / (high - low)
    figure = new_figure(wide * len(heights) + 4.9, 4.8)
    widths = (*[wide] * len(heights), 4.0)
    *machines, curve = figure.subplots(1, len(widths), width_ratios=widths)
    scale, colours = Normalize(0.0, top_of_scale(solution) / _BAR), mpl.colormaps[PRESSURE_COLOURS]
    figure.colorbar(ScalarMappable(scale, PRESSURE_COLOURS), ax=machines, shrink=0.6, pad=0.02)
    degrees = np.degrees(angle - angle[0])
    curve.plot(degrees, pressure[:, 0] / _BAR)
    label = description.families[0].name.replace("_", " ")
    curve.set(xlabel="Shaft angle (deg)", ylabel=f"Pressure in a {label} chamber (bar)")
    cursor = curve.axvline(0.0, color=ORANGE, linewidth=1.2)
    largest = 1.0 if forces is None else max(float(np.hypot(*forces.T).max()), 1.0)
    turning = part(progress, "drawing")
    with draft_of(final) as draft:
        writing = draft.with_name(f"{draft.name}{final.suffix}")
        try:
            with writer.saving(figure, str(writing), dpi=100):
                for frame in range(frames):
                    asked = angle[0] + frame / frames * description.pitch_angle
                    k = int(np.argmin(np.abs(angle - asked)))
                    at_ports = {name: colours(scale(p[k] / _BAR)) for name, p in ports.items()}
                    spaces = colours(scale(pressure[k] / _BAR))
                    for machine, height in zip(machines, heights, strict=True):
                        machine.clear()
                        cut = section_at(description, float(angle[k]), height)
                        inside = spaces[cut.chambers]
                        draw_section(machine, cut.drawn, cut.shaft_angle, at_ports, inside)
                        machine.set_title(cut.title)
                    # those on the whole width stand at its middle
                    middle = machines[len(machines) // 2]
                    for body, force in zip(
                        description.bodies, () if forces is None else forces[k], strict=False
                    ):
                        start = 1e3 * np.asarray(body.center)
                        end = start + 1e3 * _ARROW * (high - low) * force / largest
                        middle.annotate(
                            "", end, start, arrowprops={"arrowstyle": "-|>", "color": GREY, "lw": 2}
                        )
                    cursor.set_xdata([degrees[k]] * 2)
                    writer.grab_frame()
                    tell(turning, (frame + 1) / frames, f"picture {frame + 1} of {frames}")
            writing.replace(draft)
        finally:
            writing.unlink(missing_ok=True)
    return final
