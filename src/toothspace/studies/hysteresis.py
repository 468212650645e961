"""``kind = "hysteresis"``: pressures up and down, a name of the path of a floating bearing."""

from toothspace.studies.bearing_path import HysteresisStudy, figures, run
from toothspace.studies.study import Study

STUDY = Study(HysteresisStudy, run, figures)
