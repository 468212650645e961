"""Searches with several objectives: share of the best front that a budget of designs reaches.

    python -m benchmarks designs

Gears of equal displacement by their kinematics: ripple and room as objectives, contact ratio and
face width as constraints, so that an evaluation costs nothing and only the search is measured. The
hypervolume is that of the front found, over that of the front of a million designs. Libraries that
are not dependencies (optuna) are left out where they are not installed.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from importlib.util import find_spec

import numpy as np

import toothspace as ts
from toothspace.studies.variation import unit_samples

KEYS = {
    "tooth_count": (9.0, 19.0),
    "module": (1.8e-3, 3.4e-3),
    "profile_shift": (0.0, 0.7),
    "normal_backlash": (0.08e-3, 0.16e-3),
    "pressure_angle": (0.29, 0.44),
    "dedendum": (1.15, 1.45),
    "tool_tip_radius": (0.15, 0.45),
}
REFERENCE = np.array([20.0, 30.0])
BUDGETS = (100, 200, 400, 1000)
SEEDS = range(6)
POPULATION = 40
SPREAD = 5.0  # as the study pareto has it

Search = Callable[[int, int], np.ndarray]


def evaluated(shares: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Objectives and violations, shape (designs, 2), of points of the unit cube."""
    values = {
        f"machine.gears.{name}": low + share * (high - low)
        for (name, (low, high)), share in zip(KEYS.items(), shares.T, strict=True)
    }
    values["machine.gears.tooth_count"] = np.minimum(
        np.floor(values["machine.gears.tooth_count"]), 18.0
    )
    designs = ts.evaluate_designs("egm12_pump", values, addendum=1.1, displacement="4.95 cm^3/rev")
    objectives = np.column_stack([designs["flow_ripple_percent"], designs["envelope_cm3"]])
    width, ratio = designs["face_width_mm"], designs["contact_ratio"]
    broken = np.column_stack([1.1 - ratio, np.maximum(6.0 - width, width - 14.0) / 14.0])
    impossible = ~designs.keeps_rules
    objectives[impossible], broken[impossible] = 1e3, 1.0
    return objectives, np.maximum(broken, 0.0)


def hypervolume(objectives: np.ndarray) -> float:
    """Area between a front of two objectives and the reference."""
    inside = objectives[(objectives < REFERENCE).all(axis=1)]
    area, reached = 0.0, REFERENCE[1]
    for first, second in inside[np.lexsort((inside[:, 1], inside[:, 0]))]:
        if second < reached:
            area += (REFERENCE[0] - first) * (reached - second)
            reached = second
    return area


def kept(objectives: np.ndarray, broken: np.ndarray) -> np.ndarray:
    return objectives[broken.sum(axis=1) == 0.0]


def sobol(budget: int, seed: int) -> np.ndarray:
    """Points without any search."""
    return kept(*evaluated(unit_samples(len(KEYS), "sobol", budget, seed)))


def pymoo_nsga2(budget: int, seed: int) -> np.ndarray:
    from pymoo.algorithms.moo.nsga2 import NSGA2
    from pymoo.core.problem import Problem
    from pymoo.operators.crossover.sbx import SBX
    from pymoo.operators.mutation.pm import PM
    from pymoo.optimize import minimize

    found = []

    class Gears(Problem):
        def __init__(self) -> None:
            super().__init__(n_var=len(KEYS), n_obj=2, n_ieq_constr=2, xl=0.0, xu=1.0)

        def _evaluate(self, x: np.ndarray, out: dict[str, np.ndarray], *_: object) -> None:
            objectives, broken = evaluated(x)
            found.append(kept(objectives, broken))
            out["F"], out["G"] = objectives, broken

    first = unit_samples(len(KEYS), "sobol", max(POPULATION, budget // 3), seed)
    search = NSGA2(
        pop_size=POPULATION,
        sampling=first,
        crossover=SBX(eta=SPREAD, prob=0.9),
        mutation=PM(eta=SPREAD, prob=0.9),
    )
    minimize(Gears(), search, ("n_eval", budget), seed=seed)
    return np.vstack(found)[:budget]


def optuna_search(sampler: Callable[..., object], budget: int, seed: int) -> np.ndarray:
    import optuna

    optuna.logging.set_verbosity(optuna.logging.ERROR)
    study = optuna.create_study(directions=["minimize"] * 2, sampler=sampler(seed))
    found = []
    for _ in range(budget):
        trial = study.ask()
        share = np.array([[trial.suggest_float(str(k), 0.0, 1.0) for k in range(len(KEYS))]])
        objectives, broken = evaluated(share)
        trial.set_user_attr("broken", broken[0].tolist())
        study.tell(trial, objectives[0].tolist())
        found.append(kept(objectives, broken))
    return np.vstack(found)


def optuna_nsga2(budget: int, seed: int) -> np.ndarray:
    from optuna.samplers import NSGAIISampler

    return optuna_search(
        lambda s: NSGAIISampler(
            seed=s, population_size=POPULATION, constraints_func=lambda t: t.user_attrs["broken"]
        ),
        budget,
        seed,
    )


def optuna_tpe(budget: int, seed: int) -> np.ndarray:
    from optuna.samplers import TPESampler

    return optuna_search(
        lambda s: TPESampler(
            seed=s, multivariate=True, constraints_func=lambda t: t.user_attrs["broken"]
        ),
        budget,
        seed,
    )


def main() -> None:
    """Print shares of the hypervolume and the time that the search itself takes."""
    scanned = [kept(*evaluated(unit_samples(len(KEYS), "sobol", 2**18, k))) for k in range(4)]
    whole = hypervolume(np.vstack(scanned))
    print(f"share of the hypervolume, mean of 6 seeds (lowest) after {BUDGETS}; time for a design")
    searches: dict[str, Search] = {"Sobol sequence, no search": sobol}
    if find_spec("pymoo"):
        searches["pymoo NSGA-II"] = pymoo_nsga2
    if find_spec("optuna"):
        searches |= {"optuna NSGA-II": optuna_nsga2, "optuna TPE": optuna_tpe}
    for name, search in searches.items():
        start, cells = time.perf_counter(), []
        for budget in BUDGETS:
            shares = [hypervolume(search(budget, seed)) / whole for seed in SEEDS]
            cells.append(f"{np.mean(shares):7.3f} ({min(shares):.3f})")
        spent = 1e3 * (time.perf_counter() - start) / (sum(BUDGETS) * len(SEEDS))
        print(f"  {name:28s}{''.join(cells)}{spent:9.2f} ms")


if __name__ == "__main__":
    main()
