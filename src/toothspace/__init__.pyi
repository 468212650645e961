from . import films as films
from .api import describe as describe
from .api import evaluate_designs as evaluate_designs
from .api import new_case as new_case
from .api import prepare as prepare
from .api import simulate as simulate
from .api import simulate_all as simulate_all
from .case import Case as Case
from .case import load_case as load_case
from .case.shipped import cases as cases
from .core.errors import CaseError as CaseError
from .core.errors import GeometryError as GeometryError
from .core.errors import ToothspaceError as ToothspaceError
from .core.status import Status as Status
from .core.units import Quantity as Quantity
from .fmi.export import export_fmu as export_fmu
from .fmi.machine_unit import export_machine as export_machine
from .library import fluids as fluids
from .report import compare as compare
from .results.solution import Solution as Solution
from .results.solution import load_solution as load_solution
from .run.run import Run as Run
from .studies import StudyResult as StudyResult
from .studies import run_study as run_study
from .studies.sweep import sweep as sweep

__version__: str
