"""Studies: many runs with one question.

============== =================================================================================
module         responsibility
============== =================================================================================
study          how a study is declared and run, finished points on disk, what it gives back
points         points of a study, evaluated once each, as datasets, lists and tables
workers        processes that share the points
variation      keys that several studies have; values of varied keys: grids, samples, distributions
measured       measured columns
least_squares  fits within bounds
bearing_points operating points of a floating bearing, in memory and on disk
surrogate      Gaussian processes through the points of a finished study, with error bars
reduce         tables of films for the lumped preset
============== =================================================================================

Every other module is a study: it declares keys, run and figures in ``STUDY``, under its own name.
"""

from __future__ import annotations

from toothspace.studies.study import StudyContext, StudyResult, StudyTable, run_study, study_figures

__all__ = ["StudyContext", "StudyResult", "StudyTable", "run_study", "study_figures"]
