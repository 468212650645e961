"""Interrupts, step limits and what is kept between runs."""

from __future__ import annotations

import dataclasses
import os
import signal
import subprocess
import sys
import time
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.conftest import posix
from tests.toy_machine import toy_system
from toothspace import api
from toothspace.case import Case
from toothspace.case.fingerprint import fingerprint
from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.model.assembly import System
from toothspace.run import running_in
from toothspace.solver import cyclic
from toothspace.solver.cyclic import RunPlan, march_revolutions

REPOSITORY = Path(__file__).resolve().parents[3]
MOTOR = REPOSITORY / "cases" / "egm12_motor.toml"


@pytest.fixture(scope="module")
def system() -> System:
    return toy_system()


def test_an_interrupt_inside_a_revolution_keeps_the_revolutions_before(
    system: System, monkeypatch: pytest.MonkeyPatch
) -> None:
    plan = RunPlan(revolutions=5, samples_per_revolution=36)
    two = march_revolutions(system, dataclasses.replace(plan, revolutions=2))
    real = cyclic.start_march
    done: list[Any] = []

    def start(*arguments: Any) -> Any:
        march = real(*arguments)

        def advance(times: Any) -> Any:
            if len(done) == 2 * cyclic._PIECES:
                raise KeyboardInterrupt
            done.append(march.advance(times))
            return done[-1]

        return SimpleNamespace(advance=advance, system=system, statistics=march.statistics)

    monkeypatch.setattr(cyclic, "start_march", start)
    history = march_revolutions(system, plan)
    assert history.status is Status.INTERRUPTED
    assert history.revolutions == 2
    np.testing.assert_array_equal(history.states, two.states)


def test_an_interrupt_in_the_first_revolution_has_no_result(
    system: System, monkeypatch: pytest.MonkeyPatch
) -> None:
    def start(*_arguments: Any) -> Any:
        raise KeyboardInterrupt

    monkeypatch.setattr(cyclic, "start_march", lambda *a: SimpleNamespace(advance=start))
    with pytest.raises(KeyboardInterrupt):
        march_revolutions(system, RunPlan(revolutions=5))


def test_the_step_limit_reaches_the_integrator(system: System) -> None:
    history = march_revolutions(system, RunPlan(revolutions=50, max_steps=300))
    assert history.status is Status.MAX_STEPS
    steps = history.statistics["steps"] + history.statistics["rejected"]
    assert steps == pytest.approx(300, abs=2)


@pytest.fixture
def motor(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Case:
    """The motor with running-in replaced by stand-ins, and an empty store."""
    monkeypatch.setattr(running_in, "folder", lambda: tmp_path / "store")
    monkeypatch.setattr(running_in, "assemble", lambda *_: None)
    monkeypatch.setattr(running_in, "running_in_depths", lambda _: {"drive_gear": np.arange(3.0)})
    return api.load_case(MOTOR)


def machine() -> Any:
    """What running-in needs of a description."""
    state = SimpleNamespace(pressure=260e5, shaft_speed=157.0, temperature=323.15)
    return SimpleNamespace(
        running_in=state, mode="motor", drain_pressure=1e5, with_running_in=lambda depths: depths
    )


def run_in(case: Case) -> running_in.Tracks:
    return running_in.run_in(case, machine())


def marches(monkeypatch: pytest.MonkeyPatch, status: Status) -> list[RunPlan]:
    """Let every march end with a status; the plans that were asked for."""
    asked: list[RunPlan] = []

    def march(_system: Any, plan: RunPlan, *_: object) -> Any:
        asked.append(plan)
        return SimpleNamespace(status=status)

    monkeypatch.setattr(running_in, "march_revolutions", march)
    return asked


def test_running_in_is_computed_once(motor: Case, monkeypatch: pytest.MonkeyPatch) -> None:
    asked = marches(monkeypatch, Status.DONE)
    first = run_in(motor)
    other_speed = api.load_case(MOTOR, ["operating_point.shaft_speed=900 rpm"])
    again = run_in(other_speed)
    assert len(asked) == 1
    np.testing.assert_array_equal(first.depths["drive_gear"], again.depths["drive_gear"])
    run_in(api.load_case(MOTOR, ["machine.gears.face_width=8 mm"]))
    run_in(api.load_case(MOTOR, ["fluid.name=iso_vg_32"]))
    assert len(asked) == 3


def test_running_in_that_was_interrupted_is_not_used(
    motor: Case, monkeypatch: pytest.MonkeyPatch
) -> None:
    marches(monkeypatch, Status.INTERRUPTED)
    with pytest.raises(KeyboardInterrupt):
        run_in(motor)
    assert not running_in.folder().exists()


def test_running_in_that_failed_is_used_but_not_kept(
    motor: Case, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = marches(monkeypatch, Status.STEP_TOO_SMALL)
    depths = run_in(motor).depths
    assert depths
    assert not running_in.folder().exists()
    assert asked[0].max_steps == motor.run.step_limit(over_time=False)


def test_a_broken_file_of_depths_counts_as_none(
    motor: Case, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = marches(monkeypatch, Status.DONE)
    first = run_in(motor)
    (path,) = running_in.folder().glob("*.npz")
    path.write_bytes(path.read_bytes()[:40])
    again = run_in(motor)
    assert len(asked) == 2
    np.testing.assert_array_equal(first.depths["drive_gear"], again.depths["drive_gear"])


def test_fingerprints_follow_content() -> None:
    spec = api.load_case(MOTOR).machine_spec
    same = api.load_case(MOTOR, ["operating_point.shaft_speed=900 rpm"]).machine_spec
    other = api.load_case(MOTOR, ["machine.lateral.side_gap=9 um"]).machine_spec
    assert fingerprint(spec) == fingerprint(same)
    assert fingerprint(spec) != fingerprint(other)
    assert fingerprint(1.0) != fingerprint(1)
    assert fingerprint(("a", "b")) != fingerprint(("ab",))
    assert fingerprint(np.zeros(2)) != fingerprint(np.zeros(2, dtype=np.float32))


def test_tables_of_a_machine_are_kept_between_points(monkeypatch: pytest.MonkeyPatch) -> None:
    built: list[Any] = []

    def describe(spec: Any) -> Any:
        built.append(spec)
        return object()

    monkeypatch.setattr(api, "machine_type", lambda _: SimpleNamespace(describe=describe))
    monkeypatch.setattr(api, "_machines", {})
    first = api.describe(api.load_case(MOTOR))
    assert api.describe(api.load_case(MOTOR, ["fluid.temperature=30 degC"])) is first
    for width in range(5, 11):
        api.describe(api.load_case(MOTOR, [f"machine.gears.face_width={width} mm"]))
    assert len(built) == 7
    assert api.describe(api.load_case(MOTOR)) is not first


def test_a_case_that_fails_is_a_value(monkeypatch: pytest.MonkeyPatch) -> None:
    answers: list[Any] = [CaseError("key", "this", "that"), FloatingPointError("lost"), "fine"]

    def simulate(_case: Any) -> Any:
        answer = answers.pop(0)
        if isinstance(answer, Exception):
            raise answer
        return answer

    monkeypatch.setattr(api, "simulate", simulate)
    found = api.simulate_all([api.load_case(MOTOR)] * 3)
    assert type(found[0]) is CaseError
    assert str(found[0]) == "key: found this, allowed that"
    assert isinstance(found[1], FloatingPointError)
    assert found[2] == "fine"


@posix
@pytest.mark.slow
@pytest.mark.parametrize("end", [signal.SIGINT, signal.SIGTERM])
def test_ctrl_c_and_the_end_of_a_job_keep_the_result(end: signal.Signals, tmp_path: Path) -> None:
    target = tmp_path / "result.nc"
    # a test run in the background inherits that interrupts are ignored
    program = (
        "import signal, sys; signal.signal(signal.SIGINT, signal.default_int_handler); "
        "from toothspace.cli import main; sys.exit(main(sys.argv[1:]))"
    )
    command = [sys.executable, "-c", program, "run", str(MOTOR), "-o", str(target)]
    # once to the end, so that nothing is compiled or run in the second time
    subprocess.run([*command, "--set", "run.revolutions=1"], check=True, capture_output=True)
    target.unlink()
    run = subprocess.Popen(
        [*command, "--set", "run.revolutions=100000"], stderr=subprocess.PIPE, text=True
    )
    time.sleep(20.0)
    os.kill(run.pid, end)
    _, messages = run.communicate(timeout=60.0)
    assert run.returncode == 130, messages
    assert "interrupted" in messages
    assert target.is_file()
