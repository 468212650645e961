"""``kind = "bearing_map"``: a map of a floating bearing, a name of its path."""

from toothspace.studies.bearing_path import BearingMapStudy, figures, run
from toothspace.studies.study import Study

STUDY = Study(BearingMapStudy, run, figures)
