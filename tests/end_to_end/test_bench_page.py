"""The bench in a browser: take hold of a groove edge and see the pump answer."""

from __future__ import annotations

import re
import shutil
import threading
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import shapely

import toothspace as ts
from tests.conftest import REPOSITORY
from toothspace import cli
from toothspace.app.drawing import look
from toothspace.app.handles import closed_form_of
from toothspace.app.server import BenchServer
from toothspace.case import load_case
from toothspace.core.units import to_si

playwright = pytest.importorskip("playwright.sync_api")
pytest.importorskip("starlette")

NAMES = ("chromium", "chromium-browser", "google-chrome")
CHROMIUM = next(filter(None, map(shutil.which, NAMES)), "")
ARGUMENTS = (
    "--no-sandbox", "--disable-gpu", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
)  # fmt: skip
LONGEST = 120.0
GROOVE = '[data-path="machine.relief_grooves.closing_side_offset"]'

pytestmark = pytest.mark.skipif(not CHROMIUM, reason="no Chromium on this computer")


@pytest.fixture(scope="module")
def server(tmp_path_factory: pytest.TempPathFactory) -> Iterator[BenchServer]:
    served = BenchServer(tmp_path_factory.mktemp("bench"))
    thread = threading.Thread(target=served.serve, daemon=True)
    thread.start()
    yield served
    served.stop()
    thread.join(20.0)


@pytest.fixture(scope="module")
def browser() -> Iterator[Any]:
    with playwright.sync_playwright() as running:
        found = running.chromium.launch(executable_path=CHROMIUM, args=list(ARGUMENTS))
        yield found
        found.close()


@pytest.fixture
def page(server: BenchServer, browser: Any) -> Iterator[Any]:
    context = browser.new_context(viewport={"width": 1400, "height": 900})
    opened, errors = context.new_page(), list[str]()
    context.set_default_timeout(1000.0 * LONGEST)
    opened.on("pageerror", lambda error: errors.append(str(error)))
    opened.goto(server.address)
    opened.wait_for_selector("#questions .card")
    yield opened
    context.close()
    assert errors == []


def until(page: Any, holds: str) -> None:
    """Wait until an expression holds; the policy of the page forbids evaluating texts in it."""
    end = time.monotonic() + LONGEST
    while not page.evaluate(holds):
        assert time.monotonic() < end, holds
        page.wait_for_timeout(50)


def begin(page: Any, card: str) -> None:
    page.click(f"#start .card:has-text('{card}')")
    page.wait_for_selector("#tiles .tile")


@pytest.mark.slow
def test_a_dragged_groove_lowers_the_peak(page: Any) -> None:
    assert "token" not in page.url
    begin(page, "Quiet a pump")
    before = page.evaluate("bench.answer.numbers.max_chamber_pressure_bar")
    count = page.evaluate("bench.answers.length")
    box = page.locator(f"{GROOVE} circle").last.bounding_box()
    x, y = box["x"] + box["width"] / 2.0, box["y"] + box["height"] / 2.0
    page.mouse.move(x, y)
    page.mouse.down()
    for step in range(6):
        page.mouse.move(x - 0.4 * step, y)
        page.wait_for_timeout(20)
    page.mouse.up()
    until(page, f"bench.answers.length > {count} && bench.design.version > 1")
    until(page, "bench.answer.version === bench.design.version")
    value = page.evaluate("bench.design.tables.machine.relief_grooves.closing_side_offset")
    assert 2.9 < float(value.removesuffix(" mm")) < 3.4
    assert page.evaluate("bench.answer.numbers.max_chamber_pressure_bar") < before - 5.0
    assert "from before" in page.inner_text("#tiles")
    # a label in a designer's words, the key behind it
    vapour = page.locator(".tile[title='cavitation_index_W']")
    assert "Power of collapsing vapour" in vapour.inner_text()
    until(page, "Array.isArray(bench.answer.findings)")
    # a reload loses nothing, and a second tab sees the same
    address = page.url
    page.reload()
    page.wait_for_selector("#tiles .tile")
    assert page.evaluate("bench.design.version") == 2
    other = page.context.new_page()
    other.goto(address)
    other.wait_for_selector("#tiles .tile")
    page.click("#undo")
    until(other, "bench.design.version === 3")
    until(other, "bench.design.tables.machine.relief_grooves.closing_side_offset === '3.4 mm'")


KINEMATICS = """async ([closed, rows]) => {
    const { kinematics } = await import("/static/kinematics.js");
    return rows.map(row => {
        const found = kinematics(closed, row);
        if (!found) return null;
        return { numbers: found.numbers, rules: found.rules, outlines: found.outlines() };
    });
}"""


@pytest.mark.slow
def test_closed_forms_of_the_page_are_those_of_the_program(page: Any) -> None:
    """Hundreds of gear pairs, also undercut ones, pointed ones and ones that do not mesh."""
    random, count = np.random.default_rng(7), 300
    keys = {
        "tooth_count": ("", random.integers(9, 20, count).astype(float)),
        "module": ("mm", random.uniform(2.0, 4.0, count)),
        "pressure_angle": ("deg", random.uniform(17.0, 25.0, count)),
        "profile_shift": ("", random.uniform(-0.2, 0.6, count)),
        "dedendum": ("", random.uniform(1.1, 1.3, count)),
        "normal_backlash": ("mm", random.uniform(0.05, 0.2, count)),
        "face_width": ("mm", random.uniform(5.0, 30.0, count)),
        "helix_angle": ("deg", np.where(np.arange(count) % 3 == 0, 8.0, 0.0)),
    }
    teeth = [keys[name][1] for name in ("tooth_count", "profile_shift", "module")]
    keys["tip_diameter"] = ("mm", (teeth[0] + 2.0 * teeth[1] + 1.8) * teeth[2])
    case = load_case("egm12_pump")
    si = {
        f"machine.gears.{name}": to_si(1.0, unit) * values if unit else values
        for name, (unit, values) in keys.items()
    }
    expected = ts.evaluate_designs(case, si)
    rows = [
        {f"machine.gears.{name}": float(values[k]) for name, (_, values) in keys.items()}
        for k in range(count)
    ]
    found = page.evaluate(KINEMATICS, [closed_form_of(case), rows])
    undercut = 0
    for k in np.flatnonzero(expected.valid):
        broken = expected.why(int(k))
        undercut += "design rule: undercut" in broken
        for name, value in found[k]["numbers"].items():
            assert value == pytest.approx(float(expected[name][k]), rel=1e-7), (name, rows[k])
        rules = found[k]["rules"]
        assert rules["Contact ratio"][1] == ("design rule: contact ratio" not in broken)
        assert rules["Normal backlash"][1] == ("design rule: normal backlash" not in broken)
        lands = all(ok for rule, (_, ok) in rules.items() if rule.startswith("Tip land"))
        assert lands == ("design rule: tip land" not in broken)
    assert undercut > 5
    assert np.count_nonzero(expected.valid) > 100


ROUND_ARCS = {"family": "circular_arc", "pressure_angle": None, "tip_diameter": "42.5 mm"}
SINES = {"family": "sinusoidal", "pressure_angle": None, "tip_diameter": "39.9 mm"}
CYCLOIDS = {"family": "cycloidal", "pressure_angle": None}
WIDE = ("Flow ripple", "Smallest pocket over the largest", "Root stress")
"""Rules whose values the tables find to some 1e-3, as trapped volumes and rotor outlines."""


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "given", "values"),
    [
        ("fuel14_pump", {}, {"machine.gears.profile_shift": -0.06}),
        ("egm12_motor", {}, {"machine.gears.module": 2.8}),
        ("egm12_pump", {}, {"machine.journal_bearings.diameter": 12.0}),
        ("crescent_pump", {}, {"machine.pinion.normal_backlash": 0.12}),
        ("crescent_helical", {}, {"machine.pinion.face_width": 40.0}),
        ("continuous_pump", {}, {"machine.gears.face_width": 33.0}),
        ("continuous_pump", ROUND_ARCS, {"machine.gears.tip_land": 0.5}),
        ("continuous_pump", SINES, {"machine.gears.face_width": 20.0}),
        ("continuous_pump", CYCLOIDS, {"machine.gears.normal_backlash": 0.03}),
        ("gerotor_trochoidal", {}, {"machine.rotors.lobe_radius": 8.7}),
        ("gerotor_cycloidal", {}, {"machine.rotors.eccentricity": 2.3}),
    ],
)
def test_what_follows_a_handle_is_what_the_server_draws(
    page: Any, name: str, given: dict[str, Any], values: dict[str, float]
) -> None:
    case = load_case(name).replace({f"machine.gears.{key}": v for key, v in given.items()})
    (path, value), closed = next(iter(values.items())), closed_form_of(case)
    unit = {"profile_shift": ""}.get(path.rpartition(".")[2], "mm")
    other = case.replace({path: f"{value} {unit}" if unit else value})
    seen = look(other)
    (found,) = page.evaluate(KINEMATICS, [closed, [values]])
    for number, own in found["numbers"].items():
        wide = "volume" in number or number == "flow_ripple_percent"
        expected = pytest.approx(seen["numbers"][number], rel=5e-3 if wide else 1e-4, abs=1e-6)
        assert own == expected, number
    shown = {rule["label"]: rule for rule in seen["rules"]}
    assert len(found["rules"]) > 3
    for label, (own, passed) in found["rules"].items():
        wide = label in WIDE
        assert own == pytest.approx(shown[label]["value"], rel=5e-3 if wide else 1e-4), label
        assert passed == shown[label]["passed"], label
    # outlines, about their own centres, but for the angle at which a gear stands
    rotors = closed["kind"] in ("trochoidal", "cycloidal")
    for outline, body in zip(found["outlines"], seen["section"]["bodies"], strict=False):
        drawn = body["outline"][-1 if rotors else 0]
        radii = [np.hypot(*np.array(ring).T) for ring in (outline, drawn)]
        assert radii[0].max() == pytest.approx(radii[1].max(), abs=0.01)
        assert radii[0].min() == pytest.approx(radii[1].min(), abs=0.01)
        areas = [shapely.Polygon(ring).area for ring in (outline, drawn)]
        assert areas[0] == pytest.approx(areas[1], rel=3e-3)


@pytest.mark.slow
def test_numbers_follow_the_pointer_and_each_change_has_its_share(page: Any) -> None:
    begin(page, "Quiet a pump")
    page.click("#tabs >> text=Variants")
    page.fill("#variant-name", "first")
    page.click("#variant-form button")
    page.wait_for_selector("#variants >> text=first")
    before = page.inner_text("#live [title=displacement_cm3_per_rev]")
    box = page.locator("[data-path='machine.gears.face_width'] circle").last.bounding_box()
    x, y = box["x"] + box["width"] / 2.0, box["y"] + box["height"] / 2.0
    page.mouse.move(x, y)
    page.mouse.down()
    looks = page.evaluate("bench.looks.length")
    page.mouse.move(x + 6.0, y)
    until(page, f"document.querySelector('#live [title]').textContent !== {before!r}")
    # the server has not answered yet
    assert page.evaluate("bench.looks.length") == looks
    page.mouse.up()
    until(page, "bench.design.version === 3 && bench.answer?.version === 3")
    page.focus(GROOVE)
    page.keyboard.press("Shift+ArrowLeft")
    until(page, "bench.design.version === 4 && bench.answer?.version === 4")
    page.click("#variants >> text=why?")
    page.wait_for_selector("#causes table")
    heads = page.locator("#causes th").all_inner_texts()
    assert heads[1:] == [
        "first", "gears face width", "relief grooves closing side offset", "together", "now",
    ]  # fmt: skip

    def row(key: str) -> list[float]:
        cells = page.locator(f"#causes tr[title={key}] td").all_inner_texts()[1:]
        return [float(cell.replace("−", "-")) for cell in cells]

    for key in ("mean_flow_L_per_min", "max_chamber_pressure_bar"):
        first, width, groove, rest, now = row(key)
        assert first + width + groove + rest == pytest.approx(now, rel=2e-3)
    flow, peak = row("mean_flow_L_per_min"), row("max_chamber_pressure_bar")
    assert flow[1] > 10.0 * abs(flow[2])
    assert abs(peak[2]) > abs(peak[1])


@pytest.mark.slow
def test_a_measured_torque_is_laid_over_and_spaces_are_coloured_by_leakage(
    page: Any, tmp_path: Path
) -> None:
    begin(page, "Quiet a pump")
    page.select_option("#measured-of", "torque")
    file = tmp_path / "torque.csv"
    file.write_text("angle,torque\n0,16.5\n180,17.5\n360,16.5\n")
    page.set_input_files("#measured", str(file))
    until(page, "document.getElementById('curves').innerText.includes('measured')")
    page.click("#play")
    until(page, "document.getElementById('play').getAttribute('aria-pressed') === 'true'")
    page.click("#play")
    page.select_option("#colour", "leakage")
    assert "L/min" in page.inner_text("#scale")


@pytest.mark.slow
def test_keyboard_units_and_variants(page: Any) -> None:
    begin(page, "Quiet a pump")
    page.fill("#variant-name", "first") if page.click("#tabs >> text=Variants") is None else None
    page.click("#variant-form button")
    page.wait_for_selector("#variants >> text=first")
    page.focus(GROOVE)
    page.keyboard.press("ArrowLeft")
    until(page, "bench.design.version >= 3 && bench.answer?.version === bench.design.version")
    assert "relief grooves closing side offset" in page.inner_text("#variants")
    page.click("#settings-open")
    page.select_option("#settings-form select >> nth=0", "psi")
    page.select_option("#settings-form select >> nth=4", "1,5")
    page.click("#settings-form button")
    page.click("#tabs >> text=Answer")
    assert "psi" in page.inner_text("#tiles")
    assert re.search(r"\d,\d", page.inner_text("#tiles"))


@pytest.mark.slow
def test_a_new_pump_runs_and_turns(page: Any) -> None:
    page.click(".card:has-text('Size a pump')")
    page.fill("#new-form [name=displacement]", "8")
    page.click("#new-form button[value=ok]")
    page.wait_for_selector("#tiles .tile")
    assert page.evaluate("bench.answer.status") == "done"
    page.click("#play")
    until(page, "document.getElementById('play').getAttribute('aria-pressed') === 'true'")
    until(page, "Number(document.getElementById('angle').value) > 1")
    page.click("#play")


@pytest.mark.slow
def test_one_cursor_goes_through_all_views(page: Any) -> None:
    begin(page, "Quiet a pump")
    page.click("#tabs >> text=Views")
    page.wait_for_selector(".view[data-view=loss_tree] canvas")
    page.locator(".view[data-view=outlet_pressure] canvas").hover(position={"x": 200, "y": 60})
    until(page, "Number(document.getElementById('angle').value) > 1")
    orbit = page.locator(".view[data-view=orbit_drive_gear] output")
    until(page, "document.querySelector('[data-view=orbit_drive_gear] output').textContent !== ''")
    before = orbit.inner_text()
    page.locator("#angle").press("End")
    assert orbit.inner_text() != before
    # films of the bearings, in the plane and in space
    film = page.locator(".view[data-view=journal_drive_gear]")
    film.locator("button").click()
    assert film.locator("button").get_attribute("aria-pressed") == "true"
    film.locator("canvas").hover(position={"x": 150, "y": 170})
    assert "Pressure" in film.locator("output").inner_text()


@pytest.mark.slow
def test_the_circuit_is_a_diagram_with_its_values(page: Any) -> None:
    begin(page, "Quiet a pump")
    page.click("#tabs >> text=Circuit")
    page.click("#circuit [data-element=load]")
    page.fill("#circuit input[title='operating_point.outlet_pressure']", "150 bar")
    page.keyboard.press("Tab")
    until(page, "bench.answer?.version === bench.design.version && bench.design.version === 2")
    assert 149.0 < page.evaluate("bench.answer.numbers.outlet_pressure_bar") < 151.0
    page.check("#fidelity input >> nth=0")
    until(page, "bench.design.tables.run.fidelity === 'ideal'")
    until(page, "bench.answer?.version === bench.design.version")
    efficiency = page.evaluate("bench.answer.numbers.volumetric_efficiency")
    assert efficiency == pytest.approx(1.0, abs=1e-6)


@pytest.mark.slow
def test_wrong_text_is_told_and_changes_nothing(page: Any) -> None:
    begin(page, "Quiet a pump")
    page.click("#tabs >> text=Case file")
    until(page, "document.getElementById('text').value.includes('[machine.gears]')")
    text = page.input_value("#text")
    page.fill("#text", text.replace("2.75 mm", "2.75 kg"))
    page.click("#text-apply")
    page.wait_for_selector("#problems:visible")
    assert "machine.gears.module" in page.inner_text("#problems")
    assert page.evaluate("bench.design.version") == 1
    hostile = text.replace("EGM-12", "<img src=x onerror=alert(1)>")
    page.fill("#text", hostile)
    page.click("#text-apply")
    until(page, "bench.design.version === 2")
    assert "<img" in page.inner_text("#title")
    assert page.locator("#title img").count() == 0


@pytest.mark.slow
def test_cad_files_become_a_running_machine(page: Any, repository: Path) -> None:
    page.click(".card:has-text('Check my CAD')")
    profile = repository / "cases" / "profiles"
    files = sorted(profile.glob("egm12*.txt"))[:1]
    page.set_input_files("#cad input[type=file]", [str(file) for file in files])
    page.wait_for_selector("#cad >> text=First case")
    assert "assumed" in page.input_value("#cad textarea")
    page.click("#cad >> text=Open on the bench")
    page.wait_for_selector("#tiles .tile")


@pytest.mark.slow
def test_a_study_is_stopped_goes_on_and_is_downloaded(page: Any) -> None:
    """What was finished when it was stopped is not computed again."""
    begin(page, "Quiet a pump")
    page.click("#tabs >> text=Runs")
    page.select_option("#study-form [name=key]", "machine.relief_grooves.closing_side_offset")
    for name, value in (("from", "3.2"), ("to", "3.6"), ("count", "3")):
        page.fill(f"#study-form [name={name}]", value)
    page.click("#study-form button.first")
    state, run = page.locator("#runs .run").first, "#runs .run >> nth=0"
    page.wait_for_selector(f"{run} >> text=/[12] of 3/")
    page.click(f"{run} >> text=Stop")
    page.wait_for_selector(f"{run} >> text=stopped")
    page.click(f"{run} >> text=Run again or go on")
    page.wait_for_selector(f"{run} >> a:has-text('.csv')")
    assert "bad" not in (state.locator("span").first.get_attribute("class") or "")
    with page.expect_download() as given:
        page.click(f"{run} >> a:has-text('.csv')")
    rows = Path(given.value.path()).read_text(encoding="utf-8").splitlines()
    assert len(rows) == 4
    with page.expect_download() as given:
        page.click("#downloads >> text=Case file")
    assert "[machine.relief_grooves]" in Path(given.value.path()).read_text(encoding="utf-8")


@pytest.mark.slow
def test_a_click_in_the_map_opens_that_point(page: Any) -> None:
    begin(page, "Quiet a pump")
    study = {
        "kind": "efficiency_map",
        "shaft_speed": ["1000 rpm", "2000 rpm"],
        "pressure_difference": ["50 bar", "150 bar"],
    }
    values = {"run.fidelity": "ideal", "heat": None, "study": study}
    ordered = page.evaluate(
        "async values => (await (await fetch('/api/runs', {method: 'POST', body: JSON.stringify("
        "{design: bench.design.id, kind: 'study', values})})).json()).id",
        values,
    )
    page.click("#tabs >> text=Runs")
    page.wait_for_selector("#runs .run >> nth=0 >> a:has-text('.csv')")
    page.click("#tabs >> text=Views")
    page.wait_for_selector(f"#views-of option[value='{ordered}']", state="attached")
    page.select_option("#views-of", ordered)
    page.wait_for_selector(".view[data-view=map] canvas")
    canvas = page.locator(".view[data-view=map] canvas")
    canvas.scroll_into_view_if_needed()
    box, former = canvas.bounding_box(), page.evaluate("bench.design.id")
    page.mouse.move(box["x"] + 0.75 * box["width"], box["y"] + 0.25 * box["height"])
    assert "2000" in page.locator(".view[data-view=map] output").inner_text()
    page.mouse.click(box["x"] + 0.75 * box["width"], box["y"] + 0.25 * box["height"])
    until(page, f"bench.design && bench.design.id !== '{former}'")
    point = page.evaluate("bench.design.tables.operating_point")
    assert point["shaft_speed"].startswith("2000")
    assert 150.0 <= float(point["outlet_pressure"].split()[0]) < 152.0
    assert "study" not in page.evaluate("bench.design.tables")


@pytest.mark.slow
def test_bodies_of_a_drawing_are_chosen_by_click(page: Any, tmp_path: Path) -> None:
    pytest.importorskip("OCP", reason="STEP files need the extra cad")
    from examples import pump_from_cad

    path = tmp_path / "pump.step"
    pump_from_cad.write_assembly(path, pump_from_cad.Pump())
    page.click(".card:has-text('Check my CAD')")
    page.set_input_files("#cad input[type=file]", str(path))
    page.wait_for_selector("#cad >> text=First case")
    assert page.locator("#cad .body").count() == 4
    assert "[machine.driven_gear]" in page.input_value("#cad textarea")
    page.locator("#cad .body[aria-label^='driven gear']").click()
    page.wait_for_selector("#cad .body.out")
    until(page, "!document.querySelector('#cad textarea').value.includes('[machine.driven_gear]')")
    assert "normal backlash" in page.inner_text("#cad .beside")
    page.uncheck("#cad label:has-text('housing') input")
    until(page, "document.querySelectorAll('#cad .body.out').length === 2")


@pytest.mark.slow
def test_dropped_step_files_become_a_running_machine(
    page: Any, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    pytest.importorskip("OCP", reason="STEP files need the extra cad")
    case = REPOSITORY / "cases" / "egm12_motor.toml"
    monkeypatch.chdir(tmp_path)
    assert cli.main(["geometry", str(case), "--export", "step"]) == 0
    files = sorted(tmp_path.glob("*.step"))
    page.click(".card:has-text('Check my CAD')")
    contents = [[file.name, file.read_text(encoding="utf-8")] for file in files]
    dropped = page.evaluate_handle(
        """files => {
            const data = new DataTransfer();
            for (const [name, text] of files) data.items.add(new File([text], name));
            return data;
        }""",
        contents,
    )
    page.dispatch_event("#cad", "drop", {"dataTransfer": dropped})
    page.wait_for_selector("#cad >> text=First case")
    assert "[machine.gears]" in page.input_value("#cad textarea")
    page.click("#cad >> text=Open on the bench")
    page.wait_for_selector("#tiles .tile")


@pytest.mark.slow
def test_a_strange_file_is_explained(page: Any, tmp_path: Path) -> None:
    strange = tmp_path / "strange.stl"
    strange.write_bytes(b"no solid at all")
    page.click(".card:has-text('Check my CAD')")
    page.set_input_files("#cad input[type=file]", str(strange))
    until(
        page,
        "!document.getElementById('problems').hidden || !!document.querySelector('#cad .bad')",
    )


@pytest.mark.slow
def test_without_the_cookie_nothing_is_shown(server: BenchServer, browser: Any) -> None:
    context = browser.new_context()
    page = context.new_page()
    assert page.goto(server.address.partition("?")[0]).status == 403
    assert page.goto(server.address.replace("token=", "token=x")).status == 403
    context.close()


OPENINGS = """async ([cut, recesses, depth]) => {
    const { grooveOpenings } = await import("/static/openings.js");
    const times = [];
    let found;
    for (let k = 0; k < 30; k++) {
        const began = performance.now();
        found = grooveOpenings(cut, recesses, depth);
        times.push(performance.now() - began);
    }
    return [found, Math.min(...times)];
}"""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["egm12_pump", "fuel14_pump", "crescent_pump"])
def test_openings_that_follow_a_groove_are_those_of_the_tables(page: Any, name: str) -> None:
    """Spaces of the pump as it is, cut by grooves that were moved, against the moved pump."""
    case = load_case(name).at_point({})
    grooves = case.machine.relief_grooves
    drawn = look(case, cells=True)
    assert drawn["cut"]["grooves"]
    changes = {"closing_side_offset": 0.9, "width": 1.1, "depth": 0.8}
    moved = case.replace(
        {
            f"machine.relief_grooves.{key}": f"{1e3 * factor * getattr(grooves, key)} mm"
            for key, factor in changes.items()
        }
    )
    expected = look(moved)
    recesses = expected["section"]["recesses"]
    given = [drawn["cut"], recesses, 0.8e3 * grooves.depth]
    found, time_ms = page.evaluate(OPENINGS, given)
    assert time_ms < 16.0  # a frame
    curves = {
        (one["family"], curve["role"]): curve["values"]
        for one in expected["openings"]
        for curve in one["curves"]
    }
    before = {
        (one["family"], curve["role"]): curve["values"]
        for one in drawn["openings"]
        for curve in one["curves"]
    }
    for one in found:
        place = one["family"], one["role"]
        largest = max(curves[place])
        # tables are interpolated between their nodes where a groove begins to open
        assert one["values"] == pytest.approx(curves[place], abs=0.01 * largest), place
        assert np.abs(np.subtract(curves[place], before[place])).max() > 0.03 * largest


KIDNEYS = """async ([cut, moved]) => {
    const { kidneyOpenings } = await import("/static/openings.js");
    let found, time = Infinity;
    for (let k = 0; k < 10; k++) {
        const began = performance.now();
        found = kidneyOpenings(cut, moved);
        time = Math.min(time, performance.now() - began);
    }
    return [found, time];
}"""


@pytest.mark.slow
@pytest.mark.parametrize("name", ["gerotor_trochoidal", "gerotor_cycloidal"])
def test_openings_that_follow_a_kidney_are_those_of_the_tables(page: Any, name: str) -> None:
    """Pockets of the pump as it is, cut by kidneys with other lands and radii."""
    case = load_case(name).at_point({})
    drawn = look(case, cells=True)
    inner, outer = 1.04 * drawn["cut"]["kidneys"]["inner_radius"], 20.0
    moved = {
        "land_max_half_angle": 40.0,
        "land_min_half_angle": 20.0,
        "inner_radius": inner,
        "outer_radius": outer,
    }
    given = {f"machine.ports.{key}": f"{v} deg" for key, v in moved.items() if "land" in key}
    given |= {f"machine.ports.{key}": f"{v} mm" for key, v in moved.items() if "radius" in key}
    expected = look(case.replace({"machine.ports.timing": None, **given}))
    found, time_ms = page.evaluate(KIDNEYS, [drawn["cut"], moved])
    assert time_ms < 16.0  # a frame
    curves = [
        {curve["role"]: curve["values"] for curve in shown["openings"][0]["curves"]}
        for shown in (expected, drawn)
    ]
    for one in found:
        after, before = (curve[one["role"]] for curve in curves)
        assert one["family"] == expected["openings"][0]["family"]
        assert one["values"] == pytest.approx(after, abs=0.01 * max(after)), one["role"]
        assert np.abs(np.subtract(after, before)).max() > 0.1 * max(after)
    # as they stand, from what the tables know
    for one in page.evaluate(KIDNEYS, [drawn["cut"], {}])[0]:
        assert one["values"] == pytest.approx(curves[1][one["role"]], abs=0.5)


@pytest.mark.slow
def test_the_opening_diagram_follows_the_pointer(page: Any) -> None:
    begin(page, "Quiet a pump")
    page.click("#tabs [data-name=geometry]")
    until(page, "bench.shape?.cut?.grooves.length > 0")
    box = page.locator(f"{GROOVE} circle").last.bounding_box()
    x, y = box["x"] + box["width"] / 2.0, box["y"] + box["height"] / 2.0
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x - 8.0, y)
    until(page, "bench.cut !== null")
    wider = page.evaluate(
        "[Math.max(...bench.cut[0].values), bench.cut[0].role, bench.cut[0].values.length]"
    )
    before = page.evaluate("bench.shape.cut.grooves.length && bench.shape.openings[0].angle.length")
    assert wider[1] == "outlet_groove"
    assert wider[0] > 0.0
    assert wider[2] == before  # the same angles as the curves of the tables
    # numbers and rules come from the server, without the drawing
    until(page, "bench.looks.length > 2")
    assert page.evaluate("bench.shape.section.bodies.length") == 2
    page.mouse.up()
    until(page, "bench.cut === null && bench.answer.version === bench.design.version")
    assert "Drive gear, relief grooves" in page.inner_text("#openings")
    # another machine is not held against this one, and is called by its own names
    page.goto(page.url.partition("#")[0])
    begin(page, "Gerotor")
    page.click("#tabs [data-name=geometry]")
    until(page, "document.querySelectorAll('#geometry-tiles .tile').length > 2")
    tiles = page.inner_text("#geometry-tiles")
    assert "Kinematic flow ripple" in tiles
    assert "from before" not in tiles
    assert page.inner_text("#openings-of") == "Open areas of one pocket"
    until(page, "bench.shape?.cut?.kidneys !== undefined")
    edge = page.locator('[data-path="machine.ports.land_max_half_angle"] circle').last
    box = edge.bounding_box()
    x, y = box["x"] + box["width"] / 2.0, box["y"] + box["height"] / 2.0
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + 6.0, y + 3.0)
    until(page, "bench.cut?.length === 2")
    most = "Math.max(...bench.cut[0].values)"
    assert page.evaluate(f"{most} > 0 && bench.cut[0].role === 'inlet_port'")
    page.mouse.up()


@pytest.mark.slow
@pytest.mark.parametrize(
    ("card", "kind", "filled", "expected"),
    [
        (
            "Start a motor",
            "startup",
            {"plateaus": "200 300", "starts": "2"},
            {"plateau_speed": ["200 rpm", "300 rpm"], "start_angle_count": 2},
        ),
        (
            "Balance a bushing",
            "hysteresis",
            {"least": "20", "most": "60", "steps": "2", "gap": "1", "friction": "0.02"},
            {
                "outlet_pressures": ["20 bar", "40 bar", "60 bar", "40 bar", "20 bar"],
                "start_gap": "1 um",
                "friction_coefficient": 0.02,
                "breakaway_speed": "1.6 mm/s",
            },
        ),
    ],
)
def test_start_and_hysteresis_are_asked_for_where_they_make_sense(
    page: Any, server: BenchServer, card: str, kind: str, filled: dict[str, str], expected: Any
) -> None:
    page.click(f"#start .card:has-text('{card}')")
    until(page, "bench.shape?.handles?.length > 0")
    page.click("#tabs >> text=Runs")
    offered = page.locator("#study-form [name=kind] option").evaluate_all(
        "all => all.map(o => o.value)"
    )
    assert ("startup" in offered, "hysteresis" in offered) == (kind == "startup", True)
    page.select_option("#study-form [name=kind]", kind)
    for name, value in filled.items():
        page.fill(f"#study-form [name={name}]", value)
    assert not page.is_visible("#study-form [name=samples]")
    page.click("#study-form button.first")
    run = "#runs .run >> nth=0"
    page.wait_for_selector(f"{run} >> button:has-text('Stop')")
    studies = [one["tables"].get("study") for one in server.bench.workspace.runs()]
    assert {"kind": kind, **expected} in studies
    page.click(f"{run} >> button:has-text('Stop')")
    page.wait_for_selector(f"{run} >> text=stopped")
