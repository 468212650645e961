"""Studies: many runs with one question.

============== ============================================================
module         responsibility
============== ============================================================
registry       studies by name; runs the study of a case
study          what every study is given and gives back
points         points of a study, evaluated once each
records        finished points on disk
workers        processes that share the points
variation      values of varied keys: grids, samples, distributions
sweep          many cases over varied keys
efficiency_map steady points over speed and pressure difference
lateral_points operating points of a floating bearing
hysteresis     its position as the outlet pressure goes up and down
nose_pressure  its position over the pressure on its nose
source_ripple  a machine as a source of pulsation
bearing_map    its films over speed and pressure
balance_sweep  its loops over balanced area and housing friction
============== ============================================================
"""

from __future__ import annotations

from toothspace.studies.registry import run_study, sweep
from toothspace.studies.study import StudyContext, StudyResult, StudyTable

__all__ = ["StudyContext", "StudyResult", "StudyTable", "run_study", "sweep"]
