"""Compile ahead what machines and stand-alone films need, by running one small case of each."""

from __future__ import annotations

from importlib.resources import as_file, files

from toothspace.core.compiled import compile_seconds


def warm_up() -> dict[str, float]:
    """Run the small cases of the library; what they compile is kept on disk.

    Returns
    -------
    dict
        ``compile_time_s``: seconds spent on compiling, or on loading what was kept. [s]
    """
    from toothspace import api

    started = compile_seconds()
    with as_file(files("toothspace.library") / "warmup") as folder:
        machine = folder / "machine.toml"
        for fidelity in ("lumped", "films"):
            api.simulate(api.load_case(machine, [f"run.fidelity={fidelity}"]))
        api.solve_bearing(api.load_case(folder / "bearing.toml"))
        api.solve_film(api.load_case(folder / "film.toml"))
    return {"compile_time_s": compile_seconds() - started}
