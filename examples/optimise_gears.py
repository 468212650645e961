"""Scan 100 000 gears of equal displacement for little ripple in little room, and run one.

Kinematic numbers are closed forms over arrays, so the scan takes about half a second; the design
that is chosen from the front between ripple and room is then run as a case.

    python examples/optimise_gears.py
"""

from __future__ import annotations

import numpy as np

import toothspace as ts
from toothspace.geometry.evaluated_designs import EvaluatedDesigns

COUNT = 100_000
ADDENDUM = 1.1
LARGEST_RIPPLE = 14.5


def scan(count: int) -> tuple[dict[str, np.ndarray], EvaluatedDesigns]:
    """Random gears with the displacement of the shipped pump; values in SI units."""
    rng = np.random.default_rng(0)
    gears = {
        "machine.gears.tooth_count": rng.integers(9, 19, count),
        "machine.gears.module": rng.uniform(1.8e-3, 3.4e-3, count),
        "machine.gears.profile_shift": rng.uniform(0.0, 0.7, count),
        "machine.gears.normal_backlash": rng.uniform(0.08e-3, 0.16e-3, count),
    }
    designs = ts.evaluate_designs(
        "egm12_pump", gears, addendum=ADDENDUM, displacement="4.95 cm^3/rev"
    )
    return gears, designs


def front(ripple: np.ndarray, room: np.ndarray) -> np.ndarray:
    """Designs that no other one beats in both, from the least ripple on."""
    order = np.lexsort((room, ripple))
    least = np.minimum.accumulate(room[order])
    return order[np.r_[True, least[1:] < least[:-1]]]


def main() -> None:
    """Print the front and the run of the smallest design with little ripple."""
    gears, designs = scan(COUNT)
    width, ratio = designs["face_width_mm"], designs["contact_ratio"]
    kept = np.flatnonzero(designs.keeps_rules & (width > 6.0) & (width < 14.0) & (ratio > 1.1))
    best = kept[front(designs["flow_ripple_percent"][kept], designs["envelope_cm3"][kept])]
    print(f"{designs.valid.sum()} of {COUNT} can be made, {kept.size} keep all rules and limits")
    print("teeth  module  shift  width   ripple  room")
    for k in best[:: max(len(best) // 12, 1)]:
        print(
            f"{gears['machine.gears.tooth_count'][k]:5d}"
            f"{1e3 * gears['machine.gears.module'][k]:8.3f}"
            f"{gears['machine.gears.profile_shift'][k]:7.3f}{width[k]:7.2f}"
            f"{designs['flow_ripple_percent'][k]:8.2f}%{designs['envelope_cm3'][k]:7.2f} cm3"
        )
    calm = best[designs["flow_ripple_percent"][best] <= LARGEST_RIPPLE]
    chosen = int(calm[-1])
    tip = designs["tip_diameter_mm"][chosen]
    case = ts.load_case("egm12_pump").replace(
        {
            "machine.gears.tooth_count": int(gears["machine.gears.tooth_count"][chosen]),
            "machine.gears.module": ts.Quantity(gears["machine.gears.module"][chosen], "m"),
            "machine.gears.profile_shift": float(gears["machine.gears.profile_shift"][chosen]),
            "machine.gears.tip_diameter": ts.Quantity(tip, "mm"),
            "machine.gears.face_width": ts.Quantity(width[chosen], "mm"),
            "machine.gears.normal_backlash": ts.Quantity(
                gears["machine.gears.normal_backlash"][chosen], "m"
            ),
        }
    )
    summary = ts.simulate(case).summary()
    for name in ("displacement_cm3_per_rev", "volumetric_efficiency", "flow_ripple_percent"):
        print(f"{name:28s}{summary[name]:9.4f}")


if __name__ == "__main__":
    main()
