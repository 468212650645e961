"""Studies: many runs with one question.

============== ============================================================
module         responsibility
============== ============================================================
registry       runs the study of a case
study          how a study is declared, what it is given and gives back
keys           keys that several studies have
points         points of a study, evaluated once each
records        finished points on disk
workers        processes that share the points
variation      values of varied keys: grids, samples, distributions
tabulate       records of points as datasets, lists and tables
measured       measured columns
least_squares  fits within bounds
bearing_points operating points of a floating bearing, in memory and on disk
reduce         tables of films for the lumped preset
============== ============================================================

Every other module is a study: it declares keys, run and figures in ``STUDY``, under its own name.
"""

from __future__ import annotations

from toothspace.studies.registry import run_study
from toothspace.studies.study import StudyContext, StudyResult, StudyTable, study_figures

__all__ = ["StudyContext", "StudyResult", "StudyTable", "run_study", "study_figures"]
