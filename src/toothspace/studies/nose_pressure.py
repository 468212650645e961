"""``kind = "nose_pressure"``: pressures on its nose, a name of the path of a floating bearing."""

from toothspace.studies.bearing_path import NosePressureStudy, figures, run
from toothspace.studies.study import Study

STUDY = Study(NosePressureStudy, run, figures)
