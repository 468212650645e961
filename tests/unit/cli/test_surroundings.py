"""Terminals that are narrow, streams that are closed, users without a home, masks of new files."""

from __future__ import annotations

import os
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import pytest

from tests.fake_solution import fake_solution
from toothspace.case import load_case
from toothspace.cli import main
from toothspace.core.compilation import sources
from toothspace.core.files import draft_of
from toothspace.studies import points

PROGRAM = [sys.executable, "-m", "toothspace"]
WHOLE = "Write the report of a result: a self-contained HTML page or a PDF document."


def test_help_tells_every_command_whole(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["--help"]) == 0
    shown = " ".join(capsys.readouterr().out.split())
    assert WHOLE in shown
    assert "..." not in shown.partition("Commands:")[2]


@pytest.mark.skipif(os.name != "posix", reason="shells of POSIX close streams")
@pytest.mark.parametrize("closed", ["2>&-", ">&- 2>&-", "<&- >&- 2>&-"])
def test_streams_that_are_closed_change_no_exit_code(closed: str, tmp_path: Path) -> None:
    (tmp_path / "empty.toml").write_text('schema = 1\ntitle = "empty"\n', encoding="utf-8")
    for arguments, code in ((["fluids"], 0), (["geometry", "empty.toml"], 2)):
        command = " ".join([*PROGRAM, *arguments, closed])
        assert subprocess.run(["sh", "-c", command], cwd=tmp_path, check=False).returncode == code


@pytest.mark.parametrize(("cause", "code"), [(KeyboardInterrupt(), 130), (None, 70)])
def test_an_interrupt_that_compiled_code_swallowed_is_one(
    cause: BaseException | None,
    code: int,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    """A signal while a call takes its arguments: the interpreter complains of both at once."""

    def both(*_given: object, **_named: object) -> None:
        try:
            raise SystemError(
                "an inner function returned a result with an exception set"
            ) from cause
        except SystemError as inner:
            raise SystemError("a function returned a result with an exception set") from inner

    monkeypatch.setattr("toothspace.cli.application.application", both)
    assert main(["fluids"]) == code
    assert ("Interrupted." in capsys.readouterr().err) == (code == 130)
    if cause:
        with pytest.raises(KeyboardInterrupt):
            points._evaluated(both, ("key", load_case("egm12_pump")))


@pytest.mark.skipif(os.name != "posix", reason="masks are those of POSIX")
@pytest.mark.parametrize(("mask", "mode"), [(0o077, 0o600), (0o002, 0o664), (0o022, 0o644)])
def test_new_files_have_the_permissions_that_the_user_gives(
    mask: int, mode: int, tmp_path: Path
) -> None:
    before = os.umask(mask)
    try:
        with draft_of(tmp_path / "result.nc") as draft:
            draft.write_bytes(b"content")
    finally:
        os.umask(before)
    assert (tmp_path / "result.nc").stat().st_mode & 0o777 == mode


def test_a_user_without_a_home_keeps_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    def nowhere() -> Path:
        raise RuntimeError("Could not determine home directory.")

    for name in ("TOOTHSPACE_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    sources._user_cache.cache_clear()
    monkeypatch.setattr(Path, "home", nowhere)
    try:
        root = sources.cache_root()
        assert root == sources.cache_root()
        assert root.parent.is_dir()
        if os.name == "posix":
            assert root.parent.stat().st_mode & 0o077 == 0
    finally:
        sources._user_cache.cache_clear()


@pytest.mark.skipif(os.name != "posix", reason="links need rights on Windows")
def test_a_profile_that_links_to_itself_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "gear.step").symlink_to("gear.step")
    setting = f"machine.gears.profile={tmp_path / 'gear.step'}"
    assert main(["geometry", "egm12_motor_profile", "--set", setting]) == 2
    told = capsys.readouterr().err
    assert "machine.gears.profile: found" in told


@pytest.mark.slow
@pytest.mark.skipif(not Path("/dev/full").exists(), reason="a full disk of this system")
def test_a_page_is_written_although_nobody_reads_the_text(tmp_path: Path) -> None:
    solution = fake_solution()
    case = load_case("egm12_motor").to_toml()
    solution = replace(solution, provenance={**solution.provenance, "case_toml": case})
    for name in ("one.nc", "two.nc"):
        solution.save(tmp_path / name)
    command = " ".join([*PROGRAM, "compare", "one.nc", "two.nc", "-o", "page.html", ">/dev/full"])
    subprocess.run(["sh", "-c", command], cwd=tmp_path, check=False, capture_output=True)
    assert (tmp_path / "page.html").stat().st_size > 1000
