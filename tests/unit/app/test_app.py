"""The form in the browser: what it is given, what it refuses, and a run to its report."""

from __future__ import annotations

import json
import threading
import time
from collections.abc import Iterator
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

import pytest

from toothspace.app.server import FormServer, Session
from toothspace.case import Case, load_case
from toothspace.case.shipped import cases
from toothspace.core.netcdf import read_dataset

pytestmark = pytest.mark.unit


@pytest.fixture
def server(tmp_path: Path) -> Iterator[FormServer]:
    (tmp_path / "own.toml").write_text(load_case("egm12_motor").to_toml(), encoding="utf-8")
    with FormServer(Session(tmp_path)) as served:
        thread = threading.Thread(target=served.serve_forever, daemon=True)
        thread.start()
        yield served
        _finish(served.session)
        served.shutdown()
        thread.join()


def _finish(session: Session) -> None:
    """Return when nothing runs."""
    while session.state()["running"]:
        time.sleep(0.01)


def _ask(
    server: FormServer,
    path: str,
    body: Any = None,
    *,
    query: str = "",
    token: str | None = None,
    host: str | None = None,
) -> tuple[int, bytes]:
    connection = HTTPConnection(*server.server_address[:2])
    headers = {} if host is None else {"Host": host}
    known = server.token if token is None else token
    connection.request(
        "GET" if body is None else "POST",
        f"{path}?token={known}{query}",
        None if body is None else json.dumps(body),
        headers,
    )
    answer = connection.getresponse()
    content = answer.read()
    connection.close()
    return answer.status, content


def test_form_is_served_to_this_computer_alone(server: FormServer) -> None:
    assert server.server_address[0] == "127.0.0.1"
    code, page = _ask(server, "/")
    assert code == 200
    assert b"http" not in page.replace(b"<!doctype html>", b"")
    for token, host in (("", None), ("guess", None), (None, "elsewhere.example")):
        assert _ask(server, "/", token=token, host=host)[0] == 403
        assert _ask(server, "/run", {}, token=token, host=host)[0] == 403
    assert _ask(server, "/elsewhere")[0] == 404


def test_listed_cases_open_as_they_are(server: FormServer) -> None:
    listed = json.loads(_ask(server, "/cases")[1])
    assert list(listed) == ["own.toml", *cases()]
    for name in ("own.toml", "startup_fan_drive"):
        tables = json.loads(_ask(server, "/case", query=f"&name={name}")[1])
        expected = load_case(server.session.folder / name if "." in name else name)
        assert Case.from_dict(tables) == expected
    assert _ask(server, "/case", query="&name=../own.toml")[0] == 422


def test_problems_name_their_keys(server: FormServer) -> None:
    tables = server.session.tables("egm12_pump")
    tables["machine"]["gears"]["module"] = "3"
    tables["machine"]["casing"]["radial_clearance"] = "15 kg"
    code, content = _ask(server, "/check", tables)
    assert code == 422
    problems = json.loads(content)["problems"]
    assert [line.split(": ")[1] for line in problems] == [
        "machine.gears.module",
        "machine.casing.radial_clearance",
    ]
    assert _ask(server, "/run", tables)[0] == 422
    assert _ask(server, "/check", [1, 2])[0] == 422


def test_a_study_is_run_as_one(server: FormServer, tmp_path: Path) -> None:
    tables = server.session.tables("egm12_pump")
    tables["run"]["fidelity"] = "ideal"
    tables["study"] = {
        "kind": "sweep",
        "vary": {"machine.casing.radial_clearance": ["10 um", "20 um"]},
    }
    assert _ask(server, "/run", tables)[0] == 200
    _finish(server.session)
    state = json.loads(_ask(server, "/run")[1])
    assert state["problem"] == ""
    assert "plot.sweep()" in state["result"]
    assert b"Results over machine.casing.radial_clearance" in _ask(server, "/report.html")[1]
    file = tmp_path / "study.nc"
    file.write_bytes(_ask(server, "/result.nc")[1])
    assert read_dataset(file).sizes == {"point": 2}


def test_forms_without_a_right_length_are_refused(server: FormServer) -> None:
    for length in ("-1", "many", str(2**21)):
        connection = HTTPConnection(*server.server_address[:2])
        connection.putrequest("POST", f"/check?token={server.token}")
        connection.putheader("Content-Length", length)
        connection.endheaders()
        assert connection.getresponse().status == 413, length
        connection.close()


def test_files_elsewhere_are_refused(server: FormServer, tmp_path_factory: Any) -> None:
    beyond = tmp_path_factory.mktemp("beyond") / "fluid.csv"
    beyond.write_text("temperature [degC]\n1\n")
    for path in (str(beyond), f"../{beyond.parent.name}/fluid.csv"):
        tables = server.session.tables("egm12_pump")
        tables["fluid"]["table"] = path
        code, content = _ask(server, "/check", tables)
        assert code == 422
        assert "case: fluid.table: found" in json.loads(content)["problems"][0]
        assert "allowed a file in" in json.loads(content)["problems"][0]


@pytest.mark.usefixtures("few_figures")
def test_run_gives_numbers_report_and_files(server: FormServer) -> None:
    assert _ask(server, "/result.nc")[0] == 422
    tables = {**server.session.tables("egm12_pump"), "run": {"fidelity": "ideal"}}
    assert _ask(server, "/run", tables)[0] == 200
    _finish(server.session)
    state = json.loads(_ask(server, "/run")[1])
    assert not state["running"]
    assert not state["problem"]
    assert "displacement_cm3_per_rev" in state["result"]
    code, result = _ask(server, "/result.nc")
    assert code == 200
    assert result[1:4] == b"HDF"
    text = json.loads(_ask(server, "/case.toml", tables)[1])
    assert Case.from_toml(text) == Case.from_dict(tables)


def test_run_stops_on_request(server: FormServer) -> None:
    session = server.session
    session._stopped.set()
    with pytest.raises(KeyboardInterrupt):
        session._report(0.5, "revolution 3")
    assert session.state()["share"] == 0.5
    session._report(0.6, "revolution 4")
