"""How fast the bench in the browser follows and answers: `python -m benchmarks.bench_page`.

Drives the page in Chromium over shipped machines: time to the first paint, frames while a handle is
dragged, round trips of the drawing, answers from the last cyclic state and in full, memory of all
processes. Writes `benchmarks/results/bench_page.json`; machines may be named on the command line.
Processor times hang less on what else the computer does than times on the clock.
"""

from __future__ import annotations

import json
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import psutil
from playwright.sync_api import sync_playwright

TARGET = Path(__file__).parent / "results" / "bench_page.json"
GROOVE = "machine.relief_grooves.closing_side_offset"
GAP = "machine.rotors.tip_clearance"
MACHINES = {
    "egm12_pump": (GROOVE, "machine.gears.profile_shift"),
    "egm12_motor": (GROOVE, "machine.gears.normal_backlash"),
    "fuel14_pump": (GROOVE, "machine.gears.face_width"),
    "continuous_pump": (GROOVE, GROOVE),
    "crescent_pump": (GROOVE, "machine.pinion.face_width"),
    "crescent_motor": (GROOVE, "machine.pinion.normal_backlash"),
    "gerotor_trochoidal": (GAP, "machine.rotors.lobe_radius"),
    "gerotor_cycloidal": (GAP, "machine.rotors.eccentricity"),
}
"""Shipped machines, the dimension that is changed, and the handle that is dragged."""
ARGUMENTS = ["--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-background-networking"]
CHANGES = 4
FRAMES = """() => {
    const times = [];
    let last = performance.now(), on = true;
    const next = now => {
        times.push(now - last);
        last = now;
        if (on) requestAnimationFrame(next);
    };
    requestAnimationFrame(next);
    window.stopFrames = () => { on = false; return times.slice(2); };
}"""
"""Records the time between frames of the browser."""
RUNS = 10
"""Answers after which memory is looked at."""


def until(page: Any, holds: str, longest: float = 120.0) -> None:
    end = time.monotonic() + longest
    while not page.evaluate(holds):
        if time.monotonic() > end:
            raise TimeoutError(holds)
        page.wait_for_timeout(20)


@contextmanager
def served(folder: str) -> Iterator[tuple[psutil.Process, str]]:
    """The server in a process of its own, and its address."""
    command = [sys.executable, "-m", "toothspace", "app", folder, "--no-browser"]
    with subprocess.Popen(command, stderr=subprocess.PIPE, text=True) as running:
        assert running.stderr is not None
        told = (re.search(r"http://\S+", line) for line in running.stderr)
        yield psutil.Process(running.pid), next(filter(None, told)).group()
        running.terminate()


def processes(server: psutil.Process) -> list[psutil.Process]:
    """The server and what it started."""
    return [server, *server.children(recursive=True)]


def processor_time(server: psutil.Process) -> float:
    """Of the server and its processes, which does not hang on what else the computer does. [s]."""
    every = [p.cpu_times() for p in processes(server)]
    return sum(times.user + times.system for times in every)


def asked(page: Any, path: str, given: dict[str, Any]) -> Any:
    """What the server answers to the page."""
    return page.evaluate(
        "async ([path, given]) => (await fetch(path, {method: 'POST', "
        "body: JSON.stringify(given)})).json()",
        [path, given],
    )


def answer_cost(page: Any, server: psutil.Process, design: str, path: str) -> dict[str, float]:
    """Processor time of drawings and answers, asked for beside the page."""
    own = f"/api/designs/{design}"
    handles = asked(page, f"{own}/look", {})["handles"]
    value = next(handle for handle in handles if handle["path"] == path)
    costs: dict[str, list[float]] = {"look": [], "answer": [], "full": []}

    def cost(kind: str, where: str, given: dict[str, Any]) -> None:
        started = processor_time(server)
        asked(page, f"{own}/{where}", given)
        costs[kind].append(processor_time(server) - started)

    for k in range(CHANGES):
        given = {path: f"{value['value'] * (1.0 - 0.01 * (k + 1)):.6g} {value['unit']}"}
        cost("look", "look", {"values": given, "drag": True})
        asked(page, f"{own}/change", {"values": given})
        cost("answer", "answer", {})
    cost("full", "answer", {"full": True})
    return {f"{name}_processor_s": round(statistics.median(c), 3) for name, c in costs.items()}


def measure(page: Any, name: str, path: str, dragged: str) -> dict[str, Any]:
    began = time.perf_counter()
    design = page.evaluate(
        "async name => (await (await fetch('/api/designs', {method: 'POST', "
        "body: JSON.stringify({case: name})})).json()).id",
        name,
    )
    page.evaluate("id => { location.hash = id; }", design)
    until(page, f"bench.design?.id === '{design}' && bench.answers.some(a => a.full)")
    opened = time.perf_counter() - began
    slider = page.locator(f".dimension[data-path='{path}'] input[type=text]")
    for k in range(CHANGES):
        count = page.evaluate("bench.answers.length")
        slider.focus()
        page.keyboard.press("ArrowUp" if k % 2 else "ArrowDown")
        until(page, f"bench.answers.length > {count}")
    page.wait_for_timeout(200)
    page.evaluate("bench.frames.length = bench.follows.length = 0")
    page.locator("#picture").scroll_into_view_if_needed()
    box = page.locator(f"#handles [data-path='{dragged}'] circle").last.bounding_box()
    x, y = box["x"] + box["width"] / 2.0, box["y"] + box["height"] / 2.0
    page.mouse.move(x, y)
    page.mouse.down()
    page.evaluate(FRAMES)
    for step in range(90):
        page.mouse.move(x + 0.2 * (step % 10), y + 0.2 * (step % 10))
        page.wait_for_timeout(12)
    apart = page.evaluate("window.stopFrames()")
    paints, follows = page.evaluate("[bench.frames.map(f => f.paint), bench.follows]")
    page.mouse.up()
    page.wait_for_timeout(300)
    answers, looks = page.evaluate("bench.answers"), page.evaluate("bench.looks")
    quick = [a["ms"] / 1e3 for a in answers if not a["full"]][1:]
    return {
        "open_to_settled_s": round(opened, 2),
        "answer_median_s": round(statistics.median(quick), 3),
        "answer_worst_s": round(max(quick), 3),
        "look_median_ms": round(statistics.median(looks), 1),
        "frame_median_ms": round(statistics.median(apart), 1),
        "frame_95_ms": round(statistics.quantiles(apart, n=20)[-1], 1),
        "frames_per_second": round(1e3 * len(apart) / sum(apart), 1),
        "paint_median_ms": round(statistics.median(paints), 2),
        "closed_forms_median_ms": round(statistics.median(follows), 2) if follows else None,
    }


def main(names: Sequence[str] = ()) -> None:
    browser = next(filter(None, map(shutil.which, ("chromium", "chromium-browser"))), None)
    with (
        tempfile.TemporaryDirectory() as folder,
        sync_playwright() as running,
        served(folder) as (server, address),
    ):
        chromium = running.chromium.launch(executable_path=browser, args=ARGUMENTS)
        page = chromium.new_page(viewport={"width": 1400, "height": 900})
        page.set_default_timeout(120_000)
        began = time.perf_counter()
        page.goto(address)
        page.wait_for_selector("#questions .card")
        found: dict[str, Any] = {
            "cores": os.cpu_count(),
            "load_average": round(os.getloadavg()[0], 1),
            "first_page_s": round(time.perf_counter() - began, 3),
        }
        paint = "performance.getEntriesByName('first-contentful-paint')[0]?.startTime"
        found["first_paint_ms"] = page.evaluate(paint)
        for name in names or MACHINES:
            path, dragged = MACHINES[name]
            found[name] = measure(page, name, path, dragged)
            page.goto(address.partition("?")[0])  # nothing asks meanwhile
            page.wait_for_selector("#questions .card")
            newest = page.evaluate(
                "async () => (await (await fetch('/api/start')).json()).designs[0].id"
            )
            found[name] |= answer_cost(page, server, newest, path)
            print(name, found[name], flush=True)
        page.goto(address.partition("?")[0] + f"#{newest}")
        page.reload()
        until(page, "bench.answers.length > 0")
        for _ in range(RUNS):
            count = page.evaluate("bench.answers.length")
            page.locator(f".dimension[data-path='{path}'] input[type=text]").focus()
            page.keyboard.press("ArrowDown")
            until(page, f"bench.answers.length > {count}")
        own = psutil.Process().children(recursive=True)
        shown = [p for p in own if "--type=renderer" in p.cmdline()]
        sizes = [p.memory_full_info().pss / 1e6 for p in processes(server)]
        found["page_memory_MB"] = round(max(p.memory_full_info().pss for p in shown) / 1e6)
        found["server_memory_MB"], found["memory_MB"] = round(sizes[0]), round(sum(sizes))
        chromium.close()
    TARGET.write_text(json.dumps(found, indent=2) + "\n", encoding="utf-8")
    print(json.dumps(found, indent=2))


if __name__ == "__main__":
    main(sys.argv[1:])
