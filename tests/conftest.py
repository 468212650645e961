"""Set-up shared by all tests: markers by folder and settings of the property tests."""

from __future__ import annotations

import os
import time
from pathlib import Path

os.environ.setdefault("MPLBACKEND", "Agg")

import pytest
from hypothesis import HealthCheck, settings

TESTS = Path(__file__).resolve().parent
posix = pytest.mark.skipif(os.name == "nt", reason="signals and devices of POSIX")
REPOSITORY = TESTS.parent

settings.register_profile(
    "toothspace",
    deadline=None,  # first call may compile
    derandomize=True,  # the same examples on every machine
    max_examples=50,
    suppress_health_check=[HealthCheck.too_slow],
)
settings.load_profile("toothspace")


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--part", metavar="K/N", help="every N-th test, from the K-th of 0 to N-1 on")
    parser.addoption("--minutes", type=float, help="tests that would begin later are skipped")
    parser.addoption("--skip-nothing", action="store_true", help="a skipped test is a failure")


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark every test with the name of its folder; keep those of the part that is asked for."""
    for item in items:
        if TESTS in item.path.parents:
            item.add_marker(item.path.relative_to(TESTS).parts[0])
    if part := config.getoption("--part"):
        mine, parts = (int(text) for text in part.split("/"))
        slow = [item for item in items if item.get_closest_marker("slow")]
        kept = slow[mine % parts :: parts]
        config.hook.pytest_deselected(items=[item for item in items if item not in kept])
        items[:] = kept


STARTED = time.monotonic()


def pytest_runtest_setup(item: pytest.Item) -> None:
    minutes = item.config.getoption("--minutes")
    if minutes is not None and time.monotonic() - STARTED > 60.0 * minutes:
        pytest.skip(f"{minutes:g} minutes are over")


@pytest.hookimpl(trylast=True)
def pytest_sessionfinish(session: pytest.Session) -> None:
    """Fail a run that may skip nothing, as where every extra is installed."""
    reporter = session.config.pluginmanager.get_plugin("terminalreporter")
    if session.config.getoption("--skip-nothing") and reporter and reporter.stats.get("skipped"):
        session.exitstatus = pytest.ExitCode.TESTS_FAILED


@pytest.fixture(scope="session")
def repository() -> Path:
    """Root folder of the checkout."""
    return REPOSITORY
