"""The bench over HTTP: who is let in, what is kept, what a machine answers, what is refused."""

from __future__ import annotations

import json
import socket
import threading
import time
from collections.abc import Callable, Iterator
from http.client import HTTPConnection
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("starlette")
pytest.importorskip("uvicorn")

from toothspace.app.guard import LARGEST_BODY
from toothspace.app.server import BenchServer
from toothspace.app.workspace import Workspace
from toothspace.case import Case, load_case
from toothspace.core.errors import CaseError
from toothspace.core.netcdf import read_dataset

pytestmark = pytest.mark.unit

GROOVE = "machine.relief_grooves.closing_side_offset"
LONGEST = 120.0


class Client:
    """What a browser does that has opened the page."""

    def __init__(self, server: BenchServer) -> None:
        self.server, self.port = server, server.port
        self.token = server.address.partition("token=")[2]
        _, headers, _ = self.raw("GET", f"/?token={self.token}", {})
        self.cookie = headers["set-cookie"].partition(";")[0]
        self.promises = headers["set-cookie"]

    def raw(
        self, method: str, path: str, headers: dict[str, str], body: bytes | None = None
    ) -> tuple[int, dict[str, str], bytes]:
        connection = HTTPConnection("127.0.0.1", self.port, timeout=LONGEST)
        try:
            connection.request(method, path, body, headers)
            answer = connection.getresponse()
            names = {name.lower(): value for name, value in answer.getheaders()}
            return answer.status, names, answer.read()
        finally:
            connection.close()

    def headers(self, **others: str) -> dict[str, str]:
        return {"Cookie": self.cookie, "Origin": f"http://127.0.0.1:{self.port}", **others}

    def get(self, path: str) -> tuple[int, Any]:
        code, headers, content = self.raw("GET", path, {"Cookie": self.cookie})
        return code, json.loads(content) if headers.get("content-type", "").endswith(
            "json"
        ) else content

    def post(self, path: str, body: Any = None, method: str = "POST") -> tuple[int, Any]:
        given = json.dumps(body or {}).encode() if not isinstance(body, bytes) else body
        code, _, content = self.raw(method, path, self.headers(), given)
        return code, json.loads(content) if content[:1] in b"{[" else content

    def design(self, **given: Any) -> dict[str, Any]:
        code, design = self.post("/api/designs", given or {"case": "egm12_pump"})
        assert code == 200, design
        return dict(design)

    def finished(self, run: str, longest: float = LONGEST) -> dict[str, Any]:
        until = time.monotonic() + longest
        while time.monotonic() < until:
            found = next(one for one in self.get("/api/runs")[1] if one["id"] == run)
            if found["state"] not in {"waiting", "running"}:
                return dict(found)
            time.sleep(0.05)
        raise TimeoutError(run)


@pytest.fixture(scope="module")
def client(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Client]:
    folder = tmp_path_factory.mktemp("bench")
    (folder / "own.toml").write_text(load_case("egm12_motor").to_toml(), encoding="utf-8")
    server = BenchServer(folder)
    thread = threading.Thread(target=server.serve, daemon=True)
    thread.start()
    yield Client(server)
    server.stop()
    thread.join(20.0)
    assert not thread.is_alive()


def test_only_who_has_shown_the_token_is_let_in(client: Client) -> None:
    for flag in ("HttpOnly", "SameSite=Strict"):
        assert flag in client.promises
    assert client.token not in client.cookie
    known, port = client.cookie, client.port
    name = known.partition("=")[0]
    for headers in (
        {},
        {"Cookie": f"{name}=guess"},
        {"Cookie": known, "Host": "elsewhere.example"},
        {"Cookie": known, "Origin": "http://elsewhere.example"},
        {"Cookie": known, "Sec-Fetch-Site": "cross-site", "Sec-Fetch-Mode": "no-cors"},
    ):
        assert client.raw("GET", "/api/start", headers)[0] == 403, headers
    assert client.raw("GET", "/?token=guess", {})[0] == 403
    assert client.raw("POST", "/api/designs", {"Cookie": known}, b"{}")[0] == 403
    other = {"Cookie": known, "Origin": f"http://127.0.0.1:{port + 1}"}
    assert client.raw("POST", "/api/designs", other, b"{}")[0] == 403
    assert client.get("/api/start")[0] == 200


def test_the_token_is_in_no_command_line(client: Client) -> None:
    with client.server.door() as door:
        assert client.token not in door
        file = Path(door.removeprefix("file://"))
        assert client.token in file.read_text(encoding="utf-8")
        assert file.stat().st_mode & 0o077 == 0
    assert not file.exists()


def test_the_page_asks_for_nothing_from_elsewhere(client: Client) -> None:
    code, headers, page = client.raw("GET", "/", {"Cookie": client.cookie})
    assert code == 200
    assert "default-src 'self'" in headers["content-security-policy"]
    assert b"http://" not in page
    assert b"https://" not in page
    total = 0
    for name in (
        "bench.js",
        "machine.js",
        "kinematics.js",
        "curves.js",
        "form.js",
        "start.js",
        "units.js",
        "dom.js",
    ):
        code, content = client.get(f"/static/{name}")
        assert code == 200
        assert b"innerHTML" not in content
        total += len(content)
    for name in ("uPlot.iife.min.js", "bench.css", "external_gear.svg"):
        total += len(client.get(f"/static/{name}")[1])
    assert total < 1_500_000
    for path in ("/static/../server.py", "/static/%2e%2e%2fserver.py", "/static/nothing.js"):
        assert client.get(path)[0] == 404, path


def test_bodies_have_limits(client: Client) -> None:
    path = "/api/designs"
    for length in ("-1", "many", str(LARGEST_BODY + 1), "9" * 5000):
        with socket.create_connection(("127.0.0.1", client.port), timeout=10.0) as given:
            lines = [
                f"POST {path} HTTP/1.1",
                f"Host: 127.0.0.1:{client.port}",
                f"Origin: http://127.0.0.1:{client.port}",
                f"Cookie: {client.cookie}",
                f"Content-Length: {length}",
            ]
            given.sendall(("\r\n".join(lines) + "\r\n\r\n").encode())
            assert given.recv(100).split()[1] in {b"413", b"400"}, length[:20]
    for body in (b'{"toml": ' * 3000, b"[" * 100_000, b'{"toml": "\\ud800"}', b"[1, 2]", b"NaN"):
        code, found = client.post(path, body)
        assert code == 422, body[:20]
        assert found["problems"]


def test_a_body_is_not_read_before_the_cookie(client: Client) -> None:
    with socket.create_connection(("127.0.0.1", client.port), timeout=5.0) as given:
        given.sendall(
            f"POST /api/designs HTTP/1.1\r\nHost: 127.0.0.1:{client.port}\r\n"
            f"Origin: http://127.0.0.1:{client.port}\r\nContent-Length: 1000000\r\n\r\n".encode()
        )
        assert given.recv(100).split()[1] == b"403"


def test_listed_cases_open_as_they_are(client: Client) -> None:
    listed = {case["name"] for case in client.get("/api/start")[1]["cases"]}
    assert {"own.toml", "egm12_pump", "startup_fan_drive"} <= listed
    for name in ("own.toml", "startup_fan_drive"):
        folder = client.server.bench.workspace.folder
        expected = load_case(folder / name if "." in name else name)
        assert Case.from_dict(client.design(case=name)["tables"]) == expected
    assert client.post("/api/designs", {"case": "../own.toml"})[0] == 422


def test_problems_name_their_keys(client: Client) -> None:
    design = client.design()
    values = {"machine.gears.module": "3", "machine.casing.radial_clearance": "15 kg"}
    code, found = client.post(f"/api/designs/{design['id']}/change", {"values": values})
    assert code == 422
    assert [line.split(": ")[1] for line in found["problems"]] == list(values)
    assert client.get(f"/api/designs/{design['id']}")[1]["tables"] == design["tables"]


def test_changes_are_undone_and_kept_over_a_reload(client: Client) -> None:
    design = client.design()
    path = f"/api/designs/{design['id']}"
    code, changed = client.post(f"{path}/change", {"values": {GROOVE: "3.2 mm"}})
    assert code == 200
    assert changed["version"] == 2
    _, undone = client.post(f"{path}/undo")
    assert undone["tables"] == design["tables"]
    _, again = client.post(f"{path}/undo", {"again": True})
    assert again["tables"] == changed["tables"]
    client.post(f"{path}/variant", {"action": "keep", "label": "near", "numbers": {"x": 1.0}})
    client.post(f"{path}/change", {"values": {GROOVE: "3.0 mm"}})
    _, back = client.post(f"{path}/variant", {"action": "restore", "label": "near"})
    assert back["tables"] == changed["tables"]
    fresh = Workspace(client.server.bench.workspace.folder)
    assert fresh.design(design["id"])["variants"]["near"]["numbers"] == {"x": 1.0}
    text = client.get(f"{path}/toml")[1]
    assert Case.from_toml(text) == Case.from_dict(changed["tables"])
    assert client.post(f"{path}/change", {"toml": text})[1]["tables"] == changed["tables"]


def test_a_look_shows_handles_where_the_section_has_them(client: Client) -> None:
    design = client.design()
    values = {GROOVE: "3.1 mm"}
    code, seen = client.post(f"/api/designs/{design['id']}/look", {"values": values, "drag": True})
    assert code == 200
    handle = next(one for one in seen["handles"] if one["path"] == GROOVE)
    assert handle["value"] == 3.1
    edge = min(x for x, _ in seen["section"]["recesses"]["groove_outlet"])
    assert handle["place"]["point"][0] == pytest.approx(edge, abs=1e-3)
    assert seen["numbers"]["displacement_cm3_per_rev"] == pytest.approx(4.95, rel=1e-3)
    assert all(set(rule) >= {"label", "passed", "allowed", "reason"} for rule in seen["rules"])
    assert client.get(f"/api/designs/{design['id']}")[1]["tables"] == design["tables"]
    # what the page draws itself is left out, the rest is the same
    asked = {"values": values, "drag": True, "numbers_only": True}
    code, numbers = client.post(f"/api/designs/{design['id']}/look", asked)
    assert code == 200
    assert numbers == {name: seen[name] for name in ("numbers", "openings", "volume", "rules")}


def test_a_changed_groove_answers_from_the_last_cyclic_state(client: Client) -> None:
    design = client.design()
    path = f"/api/designs/{design['id']}"
    _, full = client.post(f"{path}/answer", {"full": True})
    assert full["status"] == "done"
    client.post(f"{path}/change", {"values": {GROOVE: "3.2 mm"}})
    _, quick = client.post(f"{path}/answer", {})
    assert quick["status"] == "done"
    peak = "max_chamber_pressure_bar"
    assert quick["numbers"][peak] < full["numbers"][peak] - 20.0
    _, settled = client.post(f"{path}/answer", {"full": True})
    assert quick["numbers"][peak] == pytest.approx(settled["numbers"][peak], rel=0.01)
    efficiency = quick["numbers"]["overall_efficiency"]
    assert efficiency == pytest.approx(settled["numbers"]["overall_efficiency"], abs=2e-3)
    curves = settled["turn"]["curves"]
    assert max(curves["pressure_drive_gear"]["values"]) == pytest.approx(
        settled["numbers"][peak], rel=0.02
    )
    _, turning = client.get(f"{path}/turning")
    assert len(turning["cells"]) == len(turning["pressure"]) == 24
    code, content = client.get(f"{path}/download/csv")
    assert code == 200
    assert content.startswith(b"shaft_angle [rad]")


def test_teeth_that_wind_turn_in_the_middle_of_their_width(client: Client) -> None:
    tables = client.design(case="helical_slices")["tables"]
    tables["run"] = {"fidelity": "ideal"}
    path = f"/api/designs/{client.design(tables=tables)['id']}"
    _, answer = client.post(f"{path}/answer", {})
    assert answer["done"]
    _, shape = client.post(f"{path}/look", {})
    _, turning = client.get(f"{path}/turning")
    frames = {len(row) for row in (*turning["cells"], *turning["pressure"])}
    assert frames == {len(shape["section"]["cells"])} != {0}


def test_bearings_alone_and_cases_with_a_study_answer(client: Client) -> None:
    bearing = client.design(case="journal_bearing")
    code, found = client.post(f"/api/designs/{bearing['id']}/answer", {})
    assert code == 200, found
    assert found["numbers"]["friction_torque_N_m"] != 0.0
    assert client.post(f"/api/designs/{bearing['id']}/look", {}) == (200, {})
    tables = client.design(case="efficiency_map_egm12")["tables"]
    tables["run"] = {"fidelity": "ideal"}
    study = client.design(tables=tables)
    code, found = client.post(f"/api/designs/{study['id']}/answer", {})
    assert (code, found["status"]) == (200, "done")


def test_two_tabs_do_not_take_each_others_answers(client: Client) -> None:
    design = client.design()
    path, found = f"/api/designs/{design['id']}/answer", list[Any]()
    threads = [
        threading.Thread(target=lambda tab=tab: found.append(client.post(path, {"tab": tab})))
        for tab in ("one", "two")
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert [answer["status"] for _, answer in found] == ["done", "done"]


def test_files_elsewhere_are_refused(
    client: Client, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = client.server.bench.workspace.folder
    beyond = tmp_path_factory.mktemp("beyond") / "fluid.csv"
    beyond.write_text("temperature [degC]\n1\n")
    (folder / "link.csv").symlink_to(beyond)
    near = f"../{beyond.parent.name}/fluid.csv"
    for place in (str(beyond), near, "./" * 600 + near, "link.csv"):
        tables = client.design()["tables"]
        tables["fluid"] = {**tables["fluid"], "table": place}
        code, found = client.post("/api/designs", {"tables": tables})
        assert code == 422, place
        assert "allowed a file in" in found["problems"][0], place


def test_uploads_keep_to_the_folder(client: Client) -> None:
    folder = client.server.bench.workspace.folder
    code, found = client.post("/api/files/points.csv", b"0,0\n1,1\n", "PUT")
    assert (code, found["name"]) == (200, "points.csv")
    assert client.post("/api/files/points.csv", b"other", "PUT")[1]["name"] == "points_2.csv"
    assert (folder / "points.csv").read_bytes() == b"0,0\n1,1\n"
    for name in ("..%2Fx.csv", ".hidden.csv", "run.exe", "a%00.csv"):
        assert client.post(f"/api/files/{name}", b"x", "PUT")[0] in {404, 422}, name
    assert client.post("/api/files/broken.toml", b"a = ", "PUT")[0] == 422
    assert not [path for path in folder.iterdir() if path.name.startswith(".upload_")]
    code, found = client.post("/api/found", {"names": ["points.csv"]})
    assert code == 200
    assert found["problem"]
    assert client.post("/api/found", {"names": ["../own.toml"]})[0] == 422


def test_a_study_is_run_in_the_queue(client: Client, tmp_path: Path) -> None:
    study = {"kind": "sweep", "vary": {"machine.casing.radial_clearance": ["10 um", "20 um"]}}
    design = client.design()
    values = {"run.fidelity": "ideal", "study": study}
    code, run = client.post(
        "/api/runs", {"design": design["id"], "kind": "study", "values": values}
    )
    assert code == 200, run
    found = client.finished(run["id"])
    assert found["state"] == "done", found
    assert b"Results over" in client.get(f"/api/runs/{run['id']}/result.html")[1]
    name = next(file for file in found["files"] if file.endswith(".nc"))
    file = tmp_path / "study.nc"
    file.write_bytes(client.get(f"/api/runs/{run['id']}/{name}")[1])
    assert read_dataset(file).sizes == {"point": 2}
    for place in ("../run.json", "..%2f..%2fown.toml", "nothing.nc"):
        assert client.get(f"/api/runs/{run['id']}/{place}")[0] in {404, 422}
    client.post(f"/api/runs/{run['id']}", {"action": "delete"})
    assert run["id"] not in [one["id"] for one in client.get("/api/runs")[1]]


def test_a_run_is_stopped_at_once_and_the_next_one_goes_on(client: Client) -> None:
    design = client.design()
    slow = {"run.until": None, "run.revolutions": 500, "heat": None, "operating_point.line": None}
    _, first = client.post("/api/runs", {"design": design["id"], "values": slow})
    quick = {"run.fidelity": "ideal", "heat": None}
    _, second = client.post("/api/runs", {"design": design["id"], "values": quick})
    wait_for(lambda: state(client, first["id"]) == "running")
    began = time.monotonic()
    client.post(f"/api/runs/{first['id']}", {"action": "stop"})
    wait_for(lambda: state(client, first["id"]) == "stopped")
    assert time.monotonic() - began < 5.0
    assert client.finished(second["id"])["state"] == "done"


def test_simultaneous_starts_wait_for_each_other(client: Client) -> None:
    slow = {"run.until": None, "run.revolutions": 500, "heat": None, "operating_point.line": None}
    asked, ordered = {"design": client.design()["id"], "values": slow}, list[str]()
    threads = [
        threading.Thread(target=lambda: ordered.append(client.post("/api/runs", asked)[1]["id"]))
        for _ in range(6)
    ]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(set(ordered)) == 6
    wait_for(lambda: any(state(client, run) == "running" for run in ordered))
    assert sorted(state(client, run) for run in ordered) == ["running"] + 5 * ["waiting"]
    for run in client.get("/api/runs")[1]:
        if run["state"] == "waiting":
            client.post(f"/api/runs/{run['id']}", {"action": "delete"})
    for run in client.get("/api/runs")[1]:
        client.post(f"/api/runs/{run['id']}", {"action": "delete"})


def state(client: Client, run: str) -> str:
    return str(next(one["state"] for one in client.get("/api/runs")[1] if one["id"] == run))


def wait_for(holds: Callable[[], bool]) -> None:
    until = time.monotonic() + LONGEST
    while not holds():
        assert time.monotonic() < until
        time.sleep(0.05)


def test_a_new_pump_is_designed(client: Client) -> None:
    numbers = {"displacement": "14 cm^3", "pressure": "210 bar", "speed": "1500 rpm"}
    design = client.design(new={"machine": "external_gear", **numbers})
    _, seen = client.post(f"/api/designs/{design['id']}/look", {})
    assert seen["numbers"]["displacement_cm3_per_rev"] == pytest.approx(14.0, rel=2e-3)
    wrong = {"machine": "external_gear", **numbers, "speed": "1500 bar"}
    code, found = client.post("/api/designs", {"new": wrong})
    assert code == 422
    assert "1500 bar" in found["problems"][0]


def test_designs_are_found_by_their_names_only(tmp_path: Path) -> None:
    workspace = Workspace(tmp_path)
    for name in ("../../etc/passwd", "x" * 12, "", "0" * 13):
        with pytest.raises(CaseError, match="design"):
            workspace.design(name)
