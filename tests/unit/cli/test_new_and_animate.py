"""``init --new`` and ``animate`` on the command line."""

from __future__ import annotations

from pathlib import Path

import pytest
from PIL import Image

from toothspace.case import load_case
from toothspace.cli import main


def test_a_new_pump_is_written_and_refused_in_words(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    asked = ["init", "--new", "external_gear", "--displacement", "8 cm^3", "--pressure", "180 bar"]
    target = str(tmp_path / "pump.toml")
    assert main([*asked, target]) == 2
    assert "--speed: found nothing" in capsys.readouterr().err
    assert main([*asked, "--speed", "1500 rpm", target]) == 0
    case = load_case(target).check()
    assert case.title == "External gear pump, 8 cm3/rev"
    assert main([*asked, "--speed", "1500 rpm", target]) == 2
    assert main(["init"]) == 2
    assert main(["init", "egm12_pump", str(tmp_path), "--speed", "1500 rpm"]) == 2


@pytest.mark.slow
def test_a_machine_that_turns_is_a_gif(tmp_path: Path) -> None:
    result, film = tmp_path / "run.nc", tmp_path / "film.gif"
    quick = ["--set", "run.samples_per_revolution=90", "--fidelity", "ideal"]
    assert main(["run", "egm12_pump", "-o", str(result), *quick]) == 0
    assert main(["animate", str(result), "-o", str(film), "--frames", "4"]) == 0
    with Image.open(film) as picture:
        assert picture.n_frames == 4
    assert sorted(path.name for path in tmp_path.iterdir()) == ["film.gif", "run.nc"]
    assert main(["animate", "startup_fan_drive", "-o", str(tmp_path / "film.png")]) == 2
