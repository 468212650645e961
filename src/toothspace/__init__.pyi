from toothspace import films as films
from toothspace.case import Case as Case
from toothspace.case import load_case as load_case
from toothspace.core.errors import CaseError as CaseError
from toothspace.core.errors import GeometryError as GeometryError
from toothspace.core.errors import ToothspaceError as ToothspaceError
from toothspace.core.status import Status as Status
from toothspace.core.units import Quantity as Quantity
from toothspace.interactive import Solution as Solution
from toothspace.interactive import compare as compare
from toothspace.interactive import describe as describe
from toothspace.interactive import evaluate_designs as evaluate_designs
from toothspace.interactive import export_fmu as export_fmu
from toothspace.interactive import load_solution as load_solution
from toothspace.interactive import simulate as simulate
from toothspace.interactive import simulate_all as simulate_all
from toothspace.interactive import sweep as sweep

__version__: str
