// The bench: a design, its drawing, what it answers, and what becomes of it.
import { ask, by, complain, element } from "./dom.js";
import { drawCircuit, drawFidelity } from "./circuit.js";
import { Curves } from "./curves.js";
import { buildForm } from "./form.js";
import { kinematics } from "./kinematics.js";
import { Machine } from "./machine.js";
import { grooveOpenings, kidneyOpenings } from "./openings.js";
import { showStart } from "./start.js";
import { factor, fixed, fromShown, keepWords, named, number, pretty, settingsForm, text, toShown, units, unitShown } from "./units.js";

const TAB = Math.random().toString(36).slice(2);
const QUIET = 300, SETTLE = 1500, LATER = 300;
const TILES = ["volumetric_efficiency", "hydromechanical_efficiency", "overall_efficiency", "mean_flow_L_per_min", "mean_torque_N_m", "max_chamber_pressure_bar", "min_chamber_pressure_bar", "cavitation_index_W", "pressure_ripple_bar", "flow_ripple_percent", "torque_ripple_percent", "outlet_pressure_bar", "power_loss_W", "drain_temperature_degC", "startup_pressure_bar", "breakaway_time_s"];
const GEOMETRY = ["displacement_cm3_per_rev", "contact_ratio", "trapped_volume_mm3", "dead_volume_mm3", "flow_ripple_percent", "tip_land_mm", "root_clearance_mm", "center_distance_mm", "normal_backlash_mm", "operating_pressure_angle_deg"];
const LIVE = ["displacement_cm3_per_rev", "contact_ratio", "trapped_volume_mm3", "center_distance_mm", "tip_diameter_mm", "root_clearance_mm", "normal_backlash_mm", "flow_ripple_percent", "eccentricity_mm"];
const OF_SHAPE = { flow_ripple_percent: "Kinematic flow ripple" }; // the key is that of a run as well
const TABS = [["answer", "Answer"], ["views", "Views"], ["geometry", "Geometry and rules"], ["circuit", "Circuit and models"], ["variants", "Variants"], ["runs", "Runs and files"], ["keys", "All keys"], ["text", "Case file"]];
let design = null, schema = null, shape = null, answer = null, ghost = null, measured = {}, lastMoved = "";
let timer = 0, settleTimer = 0, laterTimer = 0, looking = false, wantLook = null, changing = Promise.resolve(), runs = [], runsTold = 0, playing = 0;
window.bench = { get design() { return design; }, get answer() { return answer; }, get frames() { return machine.frames; }, answers: [], looks: [], follows: [], get shape() { return shape; }, get cut() { return cut; } };

const machine = new Machine(() => {}, (handle, value) => move(handle, value), handle => commit(handle));
const curves = new Curves(by("curves"), angle => { if (answer?.turn) turnTo(angle); }), areas = new Curves(by("openings"));
by("stop").onclick = () => attempt(() => ask(`/api/designs/${design.id}/stop`, { tab: TAB }));
const say = message => { by("state").textContent = message; by("stop").hidden = !message.endsWith("…"); };
async function attempt(work) { try { complain(null); return await work(); } catch (error) { complain(error); say(""); return null; } }

// ---- one design --------------------------------------------------------------------------------
async function open(id) {
  if (location.hash !== `#${id}`) { location.hash = id; return; }
  stopPlaying();
  const found = await attempt(() => ask(`/api/designs/${id}`));
  if (!found) { location.hash = ""; return; }
  by("start").hidden = true; by("bench").hidden = false; by("design-tools").hidden = false;
  Object.assign(window.bench, { answers: [], looks: [], follows: [] });
  answer = ghost = shape = geometryBefore = null; measured = {}; machine.turn(null); machine.handles = []; machine.box = null;
  viewsDrawn = null; by("views").replaceChildren();
  by("tiles").replaceChildren(); by("verdict").textContent = ""; by("curves").replaceChildren(); curves.plots.clear();
  take(found);
  choose("answer");
  solve();
  await look({}, false, true);
}
function take(found) {
  design = found;
  by("title").textContent = design.tables.title ?? ""; document.title = `${design.tables.title ?? "bench"} · toothspace`;
  by("undo").disabled = !design.undo; by("redo").disabled = !design.redo;
  showVariants(); showCircuit(); if (!by("panel-keys").hidden) showKeys(); if (!by("panel-text").hidden) showText();
}
async function look(values, drag, fit = false) {
  const began = performance.now(), id = design.id, numbersOnly = drag && drawnHere(), cells = !drag && !by("panel-geometry").hidden;
  const found = await ask(`/api/designs/${id}/look`, { values, drag, numbers_only: numbersOnly, cells });
  if (design?.id !== id) return;
  window.bench.looks.push(performance.now() - began);
  const newest = () => { if (drag && JSON.stringify(values) !== JSON.stringify(moved())) follow(); else { followed = null; geometry(); live(); } };
  if (numbersOnly) { shape = { ...shape, ...found }; newest(); return; }
  by("left").hidden = !found.section;
  if (!found.section) return;
  shape = { ...found, cells }; cut = null;
  const now = Object.fromEntries(machine.handles.filter(h => h.now !== undefined).map(h => [h.path, h]));
  const held = machine.held;
  for (const handle of found.handles) if (now[handle.path]) { const old = now[handle.path]; Object.assign(handle, { place: old.place ?? handle.place, value: old.value, low: old.low, high: old.high, now: old.now, drawn: values[handle.path] === written(old, old.now) ? old.now - old.value : undefined }); }
  if (held) held.handle = found.handles.find(h => h.path === held.handle.path) ?? held.handle;
  if (drag) machine.turn(null);
  machine.show({ ...found.section, side: found.side }, found.handles, fit);
  if (!drag) dimensions();
  newest();
  if (!drag && !machine.turning && answer?.findings) fetchTurning(); // the answer was here first
}
// the newest values win; one question is under way at a time
async function lookSoon(values) {
  wantLook = values;
  if (looking) return;
  looking = true;
  while (wantLook) {
    const asked = wantLook; wantLook = null;
    try { await look(asked, true); complain(null); } catch (error) { complain(error); }
  }
  looking = false;
}
const movedHandles = () => machine.handles.filter(h => h.now !== undefined && h.now !== h.value);
const moved = () => Object.assign({}, ...movedHandles().map(h => h.with ?? {}), ...movedHandles().map(h => ({ [h.path]: written(h, h.now) })));
const written = (handle, value) => handle.unit ? `${value} ${handle.unit}` : value;

// moved keys that change nothing in the section but what the page moves itself
const STILL = /^(fluid|operating_point|machine\.(relief_grooves|lateral|journal_bearings|casing\.radial_clearance))\b|\.face_width$/;
const drawnHere = () => shape?.section && movedHandles().every(h => STILL.test(h.path)) && Object.entries(shape.section.recesses).every(([name, outline]) => !name.startsWith("groove_") || outline.length < 7);

// closed forms follow the pointer; what the server computes of the same values takes their place
let followed = null, following = 0, cut = null;
const KIDNEY = /^machine\.ports\.(land_m(?:ax|in)_half_angle|(?:inner|outer)_radius)$/;
function cutOpenings() {
  const own = movedHandles(), depth = machine.handles.find(h => h.path === "machine.relief_grooves.depth");
  if (shape?.cut?.kidneys && own.length && own.every(h => KIDNEY.test(h.path))) return kidneyOpenings(shape.cut, Object.fromEntries(own.map(h => [h.path.split(".").at(-1), h.now])));
  if (!shape?.cut?.grooves || !depth || !own.length || !own.every(h => h.path.startsWith("machine.relief_grooves."))) return null;
  return grooveOpenings(shape.cut, machine.section.recesses, depth.now ?? depth.value);
}
function follow() {
  following ||= requestAnimationFrame(() => {
    following = 0;
    const began = performance.now();
    followed = shape && kinematics(shape.closed, Object.fromEntries(machine.handles.filter(h => h.now !== undefined).map(h => [h.path, h.now])));
    cut = cutOpenings();
    if (!followed && !cut) return;
    if (followed) machine.follow(followed);
    geometry(); live();
    window.bench.follows.push(performance.now() - began);
  });
}
function live() {
  const found = { ...shape.numbers, ...followed?.numbers }, box = by("live"), keys = LIVE.filter(key => typeof found[key] === "number"), broken = rulesNow().filter(r => !r.passed).length;
  if (box.dataset.keys !== String(keys)) box.replaceChildren(...keys.map(key => element("span", { title: key }, `${OF_SHAPE[key] ?? named(key).label} `, element("b"))), element("span"));
  box.dataset.keys = keys;
  keys.forEach((key, k) => { const { unit } = named(key); box.children[k].lastChild.textContent = `${read(toShown(found[key], unit), unit)} ${unitShown(unit)}`; });
  box.lastChild.textContent = broken ? `${broken} design rule${broken > 1 ? "s" : ""} not met` : "all design rules met"; box.lastChild.className = broken ? "bad" : "good";
}
const rulesNow = () => shape.rules.map(r => { const now = followed?.rules[r.label]; return Number.isFinite(now?.[0]) ? { ...r, passed: now[1], shown: `${text(now[0])} ${r.shown.split(" ").slice(1).join(" ")}` } : r; });

function move(handle, value) {
  handle.now = value; lastMoved = handle.path;
  machine.preview(handle); machine.placeHandles(); showDimension(handle); follow(); lookSoon(moved());
  clearTimeout(timer); holdBack();
  timer = setTimeout(() => commit(handle), machine.held ? 1e9 : QUIET);
}
function commit() {
  clearTimeout(timer);
  const values = moved();
  if (Object.keys(values).length) change({ values });
  else tellLater();
}
function change(given) {
  holdBack();
  changing = changing.then(() => attempt(async () => {
    try { take(await ask(`/api/designs/${design.id}/change`, given)); solve(); } // drawing and answer come from two processes
    finally { for (const handle of machine.handles) { delete handle.now; } wantLook = null; await look({}, false); }
  }));
  return changing;
}
async function solve(full = false) {
  holdBack();
  const id = design.id, began = performance.now();
  say(full ? "settling: running-in and temperatures …" : "solving …");
  const found = await attempt(() => ask(`/api/designs/${id}/answer`, { full, tab: TAB }));
  if (found?.superseded) say("");
  if (!found || design?.id !== id || found.superseded || found.version !== design.version) return;
  window.bench.answers.push({ full, ms: performance.now() - began });
  const fidelity = design.tables.run?.fidelity ?? "lumped";
  if (full || fidelity !== "lumped") took[fidelity] = (performance.now() - began) / 1000;
  if (!full) ghost = answer?.first ?? answer ?? ghost;
  answer = { ...found, full, first: full ? answer?.first : undefined };
  showAnswer();
  showViews();
  say(`${full ? "settled" : "answered"} in ${text((performance.now() - began) / 1000, 2)} s`);
  settleSoon();
  tellLater();
}
// the same process answers: who goes on changing does not wait for words and pictures of the last answer
function tellLater() {
  clearTimeout(laterTimer);
  if (answer) laterTimer = setTimeout(async () => { await fetchFindings(); fetchTurning(); }, LATER);
}
// what follows an answer by itself waits until nothing changes any more
function holdBack() { clearTimeout(settleTimer); clearTimeout(laterTimer); }
function settleSoon() {
  clearTimeout(settleTimer);
  const steady = design.tables.operating_point && (design.tables.run?.fidelity ?? "lumped") === "lumped";
  if (!answer.full && steady) settleTimer = setTimeout(() => solve(true), SETTLE);
}
// a quick answer comes before what there is to know of it
async function fetchFindings() {
  const own = answer, id = design.id;
  if (own.findings) return;
  try { const found = await ask(`/api/designs/${id}/findings`); if (answer === own) { Object.assign(own, found); showAnswer(); } } catch { /* another answer is under way */ }
}
async function fetchTurning() {
  if (!answer?.turn || !shape?.section.cells.length) return;
  const version = design.version, id = design.id;
  try { const found = await ask(`/api/designs/${id}/turning`); if (design?.id === id && design.version === version && !machine.held) machine.turn(found); } catch { machine.turn(null); }
}

// ---- left: dimensions --------------------------------------------------------------------------
const GROUPS = { operating_point: "Operating point", fluid: "Fluid" };
function dimensions() {
  const wanted = by("search").value.toLowerCase(), groups = new Map();
  for (const handle of shape.handles) {
    if (wanted && !`${handle.path} ${handle.label} ${handle.doc}`.toLowerCase().includes(wanted)) continue;
    const parts = handle.path.split("."), group = GROUPS[parts[0]] ?? parts.slice(1, -1).join(", ").replace(/_/g, " ");
    if (!groups.has(group)) groups.set(group, []);
    groups.get(group).push(row(handle));
  }
  by("dimensions").replaceChildren(...[...groups].map(([name, rows]) => element("fieldset", {}, element("legend", { textContent: name[0].toUpperCase() + name.slice(1) }), ...rows)));
}
function row(handle) {
  const short = handle.path.split(".").at(-1).replace(/_/g, " "), id = `d.${handle.path}`;
  const slider = element("input", { type: "range", min: handle.low, max: handle.high, step: handle.whole ? 1 : "any", ariaLabel: handle.label }); slider.value = handle.now ?? handle.value;
  const field = element("input", { type: "text", id, title: handle.path, inputMode: "decimal" });
  const line = element("div", { className: "dimension", title: `${handle.doc}\n${handle.path}` }, element("label", { htmlFor: id, textContent: short[0].toUpperCase() + short.slice(1) }), slider, element("span", { className: "value" }, field, element("span", { textContent: unitShown(handle.unit) })));
  line.dataset.path = handle.path;
  const own = () => machine.handles.find(h => h.path === handle.path) ?? handle;
  slider.oninput = () => move(own(), machine.bounded(own(), Number(slider.value)));
  slider.onchange = () => commit();
  field.onchange = () => { const value = fromShown(number(field.value), handle.unit); if (Number.isFinite(value)) { const h = own(); h.now = handle.whole ? Math.round(value) : Number(value.toPrecision(8)); lastMoved = h.path; commit(); } };
  field.onkeydown = event => { const sign = { ArrowUp: 1, ArrowDown: -1 }[event.key]; if (sign) { event.preventDefault(); const h = own(); move(h, machine.bounded(h, (h.now ?? h.value) + sign * (h.whole ? 1 : (h.high - h.low) / 200))); } };
  queueMicrotask(() => showDimension(own()));
  return line;
}
function showDimension(handle) {
  const line = by("dimensions").querySelector(`[data-path="${CSS.escape(handle.path)}"]`);
  if (!line) return;
  const value = handle.now ?? handle.value, [slider, field] = line.querySelectorAll("input");
  if (document.activeElement !== slider) slider.value = value;
  if (document.activeElement !== field || handle.now !== undefined) field.value = text(toShown(value, handle.unit), 5);
  line.classList.toggle("moved", handle.now !== undefined && handle.now !== handle.value);
}

// ---- right -------------------------------------------------------------------------------------
// what is nothing beside the digits that anybody reads
const read = (value, unit) => unit && value !== 0 && Math.abs(value) < 5e-4 ? "≈ 0" : text(value);
function tile(key, value, before, label = named(key).label) {
  const { unit } = named(key), percent = key.endsWith("efficiency"), scale = percent ? 100 : 1;
  const shown = v => v === null || v === undefined ? null : toShown(v * scale, unit);
  const difference = before === null || before === undefined || value === null ? null : shown(value) - shown(before);
  return element("div", { className: "tile", title: key }, element("small", { textContent: label }), element("b", { textContent: `${read(shown(value), unit)} ${percent ? "%" : unitShown(unit)}`.replace(" °", unitShown(unit) === "°" ? "°" : " °") }),
    element("i", { textContent: difference === null || Math.abs(difference) < 1e-4 * Math.abs(shown(value)) ? "" : `${difference > 0 ? "+" : "−"}${text(Math.abs(difference), 3)} from before` }));
}
function sentence() {
  const n = answer.numbers;
  if (!answer.done) return answer.sentence;
  const bar = v => `${text(toShown(v, "bar"), 4)} ${unitShown("bar")}`;
  const peak = n.max_chamber_pressure_bar, out = Math.max(n.outlet_pressure_bar ?? 0, n.inlet_pressure_bar ?? 0);
  if (peak === undefined || !out) return answer.sentence;
  const calm = peak <= 1.5 * out, found = answer.findings ?? [], serious = found.filter(f => f.severity === "serious").length;
  return `${calm ? "No pressure peak to worry about" : "Trapped oil peaks high"}: at most ${bar(peak)}, ${text(peak / out, 3)} times the working pressure. Overall efficiency ${text(100 * n.overall_efficiency, 3)} %` + (serious ? `; ${serious} serious finding${serious > 1 ? "s" : ""} below.` : found.length ? `; ${found.length} thing${found.length > 1 ? "s" : ""} to know below.` : ".");
}
function showAnswer() {
  if (!by("panel-variants").hidden) showVariants();
  const before = ghost?.numbers ?? {};
  by("verdict").textContent = sentence(); by("verdict").className = answer.done ? "" : "bad";
  const own = TILES.filter(key => typeof answer.numbers[key] === "number"), shown = own.length ? own : Object.keys(answer.numbers).filter(key => typeof answer.numbers[key] === "number");
  by("tiles").replaceChildren(...shown.map(key => tile(key, answer.numbers[key], before[key])));
  by("ghost-note").textContent = ghost ? "Dashed grey: the state before the last change." : "";
  if (answer.turn) {
    const all = answer.turn.curves, old = ghost?.turn?.angle.length === answer.turn.angle.length ? ghost.turn.curves : {}, x = answer.turn.angle;
    const group = (name, title, unit, keys, height) => ({ name, title, unit, x, height, lines: keys.map(k => all[k]), ghosts: keys.slice(0, 1).map(k => old[k]?.values), measured: measured[name]?.(x) ?? null });
    const some = test => Object.keys(all).filter(test);
    const chambers = some(k => k.startsWith("pressure_")), forces = some(k => k.startsWith("force_") && all[k].values.some(v => v));
    curves.show([
      chambers.length ? group("chamber", `Pressure in one ${space()} on its way round`, "bar", chambers, 220) : null,
      all.gas && Math.max(...all.gas.values) > .01 ? group("gas", "Free gas in it", "%", ["gas"], 110) : null,
      all.outlet_pressure ? group("outlet", "Outlet pressure", "bar", ["outlet_pressure"]) : null,
      all.outlet_flow_rate ? group("flow", "Outlet flow", "L/min", ["outlet_flow_rate"]) : null,
      all.shaft_torque ? group("torque", "Shaft torque", "N m", ["shaft_torque"]) : null,
      forces.length ? group("forces", "Pressure force on the bodies", "N", forces) : null,
    ].filter(Boolean));
  } else if (answer.course) {
    const { time, curves: all } = answer.course, old = ghost?.course?.time.length === time.length ? ghost.course.curves : {};
    curves.show(Object.entries(all).map(([name, curve]) => ({ name, title: `${curve.label} over time (s)`, unit: curve.unit, x: time, xUnit: " s", lines: [curve], ghosts: [old[name]?.values] })));
  } else curves.show([]);
  const worst = Math.max(...answer.losses.map(l => Math.abs(l.watt)), 1e-9), earlier = Object.fromEntries((ghost?.losses ?? []).map(l => [l.cause + l.label, l.watt]));
  const [scale, unit, places] = worst >= 1e4 ? [1e-3, "kW", 3] : [1, "W", worst >= 100 ? 1 : 2]; // one unit and as many places for all, so that they can be compared
  by("losses").replaceChildren(...[...answer.losses].sort((a, b) => b.watt - a.watt).map(l => { const was = earlier[l.cause + l.label]; return element("div", { className: "loss" }, element("span", { textContent: `${l.cause}: ${l.label}` }), element("div", { style: `width:${Math.max(100 * l.watt / worst, .3)}%` }, was > 0 ? element("i", { style: `left:${100 * was / Math.max(l.watt, 1e-9)}%`, title: "before" }) : null), element("span", { textContent: `${fixed(scale * l.watt, places)} ${unit}` })); }));
  by("findings").hidden = !answer.findings?.length; by("no-findings").hidden = answer.findings?.length !== 0;
  by("findings").replaceChildren(...(answer.findings ?? []).map(f => element("li", { className: f.severity === "serious" ? "bad" : "" }, element("b", { textContent: `${f.kind}: ` }), `${f.text} ${f.advice}`)));
}
const space = () => design.tables.machine?.type === "gerotor" ? "pocket" : "tooth space";
let geometryBefore = null;
function geometry() {
  if (by("panel-geometry").hidden) return;
  const found = { ...shape.numbers, ...followed?.numbers };
  by("geometry-tiles").replaceChildren(...GEOMETRY.filter(key => typeof found[key] === "number").map(key => tile(key, found[key], geometryBefore?.[key], OF_SHAPE[key])));
  const now = (family, curve) => ({ ...curve, values: cut?.find(one => one.family === family && one.role === curve.role)?.values ?? curve.values });
  by("openings-of").textContent = `Open areas of one ${space()}`;
  if (!followed || cut) areas.show(shape.openings.flatMap(one => {
    const lines = one.curves.map(curve => now(one.family, curve)), grooves = lines.filter(line => line.role.endsWith("_groove")), ports = lines.filter(line => !grooves.includes(line));
    // grooves are lost beside ports that are tens of times wider
    return [["opening", "", ports], ["grooves", ", relief grooves", grooves]].filter(([, , some]) => some.length).map(([name, more, some]) => ({ name: `${name}_${one.family}`, title: `${sentenceCase(one.family)}${more}`, unit: "mm2", x: one.angle, lines: some, height: 170 }));
  }));
  const rules = rulesNow().sort((a, b) => a.passed - b.passed), failed = rules.filter(r => !r.passed), met = rules.filter(r => r.passed);
  const line = r => element("details", { className: "rule" }, element("summary", {}, element("b", { className: r.passed ? "good" : "bad", textContent: r.passed ? "✓ met" : "✗ not" }), element("span", { textContent: r.label }), element("small", { textContent: pretty(r.shown) })), element("p", { className: "small", textContent: `Allowed: ${pretty(r.allowed)}. ${r.reason}` }));
  const more = by("rules").querySelector(":scope > details.more");
  by("rules").replaceChildren(element("p", { textContent: failed.length ? `${failed.length} of ${rules.length} rules are not met.` : `All ${rules.length} rules are met.`, className: failed.length ? "bad" : "good" }), ...failed.map(line), element("details", { className: "more", open: more?.open ?? !failed.length }, element("summary", { textContent: `Met (${met.length})` }), ...met.map(line)));
}
const sentenceCase = name => { const t = name.replace(/_/g, " "); return t[0].toUpperCase() + t.slice(1); };
function flat(tables, path = "", found = {}) {
  for (const [key, value] of Object.entries(tables)) { const place = path ? `${path}.${key}` : key; if (value && typeof value === "object" && !Array.isArray(value)) flat(value, place, found); else found[place] = typeof value === "string" ? value : JSON.stringify(value); }
  return found;
}
function showVariants() {
  const kept = Object.entries(design.variants);
  if (!kept.length) { by("variants").replaceChildren(element("p", { className: "small", textContent: "Keep a state under a name, change something, and compare." })); return; }
  const states = [...kept.map(([name, v]) => [name, flat(v.tables), v.numbers]), ["now", flat(design.tables), answer?.version === design.version ? answer.numbers : {}]];
  const keys = [...new Set(states.flatMap(([, t]) => Object.keys(t)))].filter(k => new Set(states.map(([, t]) => t[k])).size > 1);
  showCauses();
  const rows = TILES.filter(k => states.some(([, , n]) => typeof n[k] === "number"));
  by("variants").replaceChildren(element("table", {},
    element("tr", {}, element("th", { textContent: "" }), ...states.map(([name], k) => element("th", {}, name, element("div", {},
      name === "now" && !(name in design.variants) ? "" : element("button", { className: "small", textContent: "back to it", onclick: () => variant({ action: "restore", label: name }, true) }), " ",
      name === "now" && !(name in design.variants) ? "" : element("button", { className: "small", textContent: "✕", ariaLabel: `Drop ${name}`, onclick: () => variant({ action: "drop", label: name }) }), " ",
      k ? element("button", { className: "small", textContent: "why?", title: `What each change from “${states[0][0]}” does to the answers`, onclick: () => explain(states[0][0], k === kept.length ? null : name) }) : "")))),
    ...keys.map(key => element("tr", { className: "differs", title: key }, element("td", { textContent: plainKey(key) }), ...states.map(([, t]) => cell(t[key])))),
    ...rows.map(key => { const { label, unit } = named(key), percent = key.endsWith("efficiency"), first = states[0][2][key]; return element("tr", { title: key }, element("td", { textContent: `${label}${unit ? `, ${unitShown(unit)}` : percent ? ", %" : ""}` }), ...states.map(([, , n], k) => { const v = n[key]; if (typeof v !== "number") return cell(null); const s = percent ? 100 : 1, shown = toShown(v * s, unit), d = typeof first === "number" ? shown - toShown(first * s, unit) : 0; return cell(text(shown) + (k && Math.abs(d) > 1e-4 * Math.abs(shown) ? ` (${d > 0 ? "+" : "−"}${text(Math.abs(d), 2)})` : "")); })); })));
}
const cell = v => element("td", { textContent: v ?? "–" }), plainKey = key => key.replace(/^machine\./, "").replace(/[._]/g, " ");
// causes: one changed key at a time, the rest by interaction
let why = null;
async function explain(from, to) {
  const version = design.version;
  clearTimeout(settleTimer); // it would take the place of this question
  say("finding causes …");
  const found = await attempt(() => ask(`/api/designs/${design.id}/causes`, { from, to, tab: TAB }));
  say("");
  if (design.version !== version) return;
  if (answer && !answer.full) settleSoon();
  if (!found || found.superseded) return;
  why = { ...found, from, to: to ?? "now", version, design: design.id }; showCauses();
}
function showCauses() {
  const box = by("causes");
  if (!why || why.design !== design.id || (why.to === "now" && why.version !== design.version)) { box.replaceChildren(); return; }
  const rows = TILES.filter(key => { const [a, b] = [why.first[key], why.second[key]], least = 2e-4 * Math.max(Math.abs(a), Math.abs(b)); return typeof a === "number" && typeof b === "number" && (Math.abs(b - a) > least || why.keys.some(k => Math.abs(k.shares[key]) > least)); });
  const share = (v, scale, unit, most) => { const shown = toShown(v * scale, unit) - toShown(0, unit), part = most ? Math.abs(v) / most : 0; return element("td", { textContent: part < .005 ? "0" : `${shown > 0 ? "+" : "−"}${text(Math.abs(shown), 3)}`, style: `background:color-mix(in srgb, var(${v > 0 ? "--two" : "--one"}) ${Math.round(45 * part)}%, transparent)` }); };
  box.replaceChildren(element("h3", { textContent: `What changed from “${why.from}” to “${why.to}”` }), element("p", { className: "small", textContent: "Each column: the answer of the first with that one change, less the answer of the first. Together: what the changes do beyond their sum." }),
    rows.length ? element("table", {}, element("tr", {}, element("th"), element("th", { textContent: why.from }), ...why.keys.map(k => element("th", { textContent: k.paths.map(plainKey).join(", "), title: k.paths.join("\n") })), why.keys.length > 1 ? element("th", { textContent: "together" }) : null, element("th", { textContent: why.to })),
      ...rows.map(key => {
        const { label, unit } = named(key), percent = key.endsWith("efficiency"), scale = percent ? 100 : 1, shares = why.keys.map(k => k.shares[key] ?? 0), rest = why.second[key] - why.first[key] - shares.reduce((a, b) => a + b, 0), most = Math.max(...shares.map(Math.abs), Math.abs(rest));
        const value = v => cell(text(toShown(v * scale, unit)));
        return element("tr", { title: key }, element("td", { textContent: `${label}${unit ? `, ${unitShown(unit)}` : percent ? ", %" : ""}` }), value(why.first[key]), ...shares.map(v => share(v, scale, unit, most)), why.keys.length > 1 ? share(rest, scale, unit, most) : null, value(why.second[key]));
      })) : element("p", { textContent: "No answer differs." }));
}
async function variant(given, solved = false) { await attempt(async () => { take(await ask(`/api/designs/${design.id}/variant`, given)); if (solved) { solve(); await look({}, false); } }); }
let fidelities = null;
const took = {};
async function showCircuit() {
  if (by("panel-circuit").hidden || !design) return;
  const set = (path, value) => change({ values: { [path]: value } });
  drawCircuit(by("circuit"), design.tables, set);
  fidelities ??= await attempt(() => ask("/api/fidelities"));
  if (fidelities) drawFidelity(by("fidelity"), fidelities, design.tables, took, set);
}
async function showKeys() { schema ??= await attempt(() => ask("/api/schema")); if (schema) buildForm(by("form"), schema, design.tables, (path, value) => change({ values: { [path]: value } })); }
async function showText() { const found = await attempt(() => ask(`/api/designs/${design.id}/toml`)); if (found !== null) by("text").value = found; }

// ---- views: films, orbits, spectra, losses of the answer, or of a run that has ended ------------
let viewsDrawn = null, viewsAsked = 0;
async function showViews() {
  if (by("panel-views").hidden || !design) return;
  const select = by("views-of"), kept = runs.filter(r => r.state === "done" && (r.kind === "run" || r.kind === "study")), had = select.value;
  select.replaceChildren(new Option("the answer", ""), ...kept.map(r => new Option(`${r.title}: ${r.kind}, ${new Date(1000 * r.begun).toLocaleTimeString()}`, r.id)));
  select.value = [...select.options].some(o => o.value === had) ? had : "";
  const run = select.value, wanted = run || (answer ? `${design.id} ${answer.version} ${answer.full}` : "");
  if (!wanted) { by("views").replaceChildren(element("p", { className: "small", textContent: "There is no answer yet." })); return; }
  const key = `${wanted} ${JSON.stringify(units)}`, asked = viewsAsked += 1;
  if (viewsDrawn === key) return;
  let found;
  try { found = await ask(run ? `/api/runs/${run}/views.json` : `/api/designs/${design.id}/views`); } catch (error) { if (asked === viewsAsked) by("views").replaceChildren(element("p", { className: "bad", textContent: error.message })); return; }
  if (asked !== viewsAsked) return; // views of an answer that were waited for may come after those of a run
  viewsDrawn = key;
  if (!found.length) { by("views").replaceChildren(element("p", { className: "small", textContent: "No views: see the report of the run." })); return; }
  toothspaceViews(by("views"), found, { text, shown: (v, unit) => [toShown(v, unit), unitShown(unit)], open: values => attempt(async () => open((await ask("/api/designs", { run, values })).id)) });
}
by("views-of").onchange = () => { viewsDrawn = null; showViews(); };
by("views-page").onclick = () => window.open(by("views-of").value ? `/api/runs/${by("views-of").value}/result.html` : `/api/designs/${design.id}/download/html`, "_blank", "noopener");
document.addEventListener("toothspace-cursor", ({ detail }) => { if (detail.over === "shaft_angle" && detail.from !== machine && answer?.turn) turnTo(detail.value, true); });

// ---- runs, studies, files ----------------------------------------------------------------------
const LINKS = [["toml", "Case file"], ["html", "Report"], ["nc", "Result (NetCDF)"], ["csv", "Samples (CSV)"], ["png", "Picture"]];
function showRuns() {
  by("downloads").replaceChildren(...LINKS.map(([ending, label]) => element("a", { className: "button", textContent: label, href: `/api/designs/${design.id}/download/${ending}`, target: ending === "html" ? "_blank" : "", rel: "noopener" })));
  by("runs").replaceChildren(...(runs.length ? runs.map(runBox) : [element("p", { className: "small", textContent: "Nothing in the queue." })]));
}
function runBox(run) {
  const under = ["waiting", "running"].includes(run.state), act = (label, action) => element("button", { className: "small", textContent: label, onclick: () => attempt(async () => { await ask(`/api/runs/${run.id}`, { action }); await loadRuns(); }) });
  const bar = element("progress"); if (run.share !== null && run.share !== undefined) bar.value = run.share;
  return element("div", { className: "run" }, element("div", { className: "row" }, element("b", { className: "grow", textContent: `${run.title}: ${run.kind}` }), element("span", { className: run.state === "failed" || run.done === false ? "bad" : "small", textContent: run.state === "done" ? run.sentence || run.status : run.state }), under ? act("Stop", "stop") : act("Run again or go on", "resume"), under ? null : act("Delete", "delete")),
    run.state === "running" ? bar : null, run.state === "running" ? element("small", { textContent: run.text ?? "" }) : null, run.problem ? element("p", { className: "bad", textContent: run.problem }) : null,
    element("div", { className: "row" }, ...(run.files ?? []).map(file => element("a", { className: "button small", textContent: file, href: `/api/runs/${run.id}/${encodeURIComponent(file)}`, target: file.endsWith(".html") ? "_blank" : "", rel: "noopener" }))));
}
// a list that was asked for before a run changed and comes after it would show the run as it was
async function loadRuns() { let told, found; do { told = runsTold; found = await ask("/api/runs"); } while (told !== runsTold); runs = found; if (design) showRuns(); }
async function startRun(kind, values) { await attempt(async () => { await ask("/api/runs", { design: design.id, kind, values }); await loadRuns(); }); }
// pump of a circuit that supplies the machine
const supplied = () => Object.values(design.tables.circuit ?? {}).find(one => one?.kind === "pump_map");
function studyForm() {
  const form = by("study-form"), choice = (name, list, label) => element("label", {}, `${label} `, element("select", { name }, ...list.map(([v, t]) => element("option", { value: v, textContent: t }))));
  const options = (shape?.handles ?? []).map(h => [h.path, h.label]), goals = TILES.slice(0, 12).map(k => [k, named(k).label]);
  const field = (name, label, value) => element("label", {}, `${label} `, element("input", { name, type: "text", value, size: 7 }));
  const kind = choice("kind", [["sweep", "Sweep over one dimension"], ["optimise", "Optimise one dimension"], ["tolerance", "Tolerance of one dimension"], ["efficiency_map", "Efficiency map"], ...(supplied() ? [["startup", "Start-up from rest"]] : []), ...(design.tables.machine?.floating_bearing ? [["hysteresis", "Hysteresis of the floating bearing"]] : [])], "Study"), key = choice("key", options, "Dimension");
  const chosen = () => shape.handles.find(h => h.path === key.querySelector("select").value), shownUnit = element("span", { className: "small" });
  const from = field("from", "From", ""), to = field("to", "To", ""), count = field("count", "Points", "5"), goal = choice("goal", [["maximise", "highest"], ["minimise", "lowest"]], "Goal"), objective = choice("objective", goals, "of");
  const width = field("tolerance", "Tolerance ±", ""), samples = field("samples", "Machines", "24");
  const speeds = [field("slowest", "Speed from", "500"), field("fastest", "to", "3000"), element("span", { className: "small", textContent: "rpm" })];
  const pressures = [field("lowest", "Pressure difference from", text(toShown(50, "bar"), 3)), field("highest", "to", text(toShown(200, "bar"), 3)), element("span", { className: "small", textContent: unitShown("bar") })];
  const speedsOfSupply = field("plateaus", "Speeds of the supply", supplied() ? String(Math.max(...supplied().speed.map(([, v]) => parseFloat(v)))) : ""), starts = field("starts", "Shaft angles at rest", "1");
  const loop = [field("least", "Outlet pressure from", text(toShown(20, "bar"), 3)), field("most", "to", text(toShown(80, "bar"), 3)), element("span", { className: "small", textContent: unitShown("bar") }), field("steps", "Steps up and down", "3"), field("gap", "Gap at the start", "2"), element("span", { className: "small", textContent: "µm" }), field("friction", "Friction coefficient in the housing, full at 1.6 mm/s", text(.01))];
  const fill = () => { const h = chosen(); if (!h) return; from.lastChild.value = text(toShown(h.low, h.unit)); to.lastChild.value = text(toShown(h.high, h.unit)); width.lastChild.value = text(.05 * Math.abs(h.value) * factor(h.unit), 3); shownUnit.textContent = unitShown(h.unit); };
  if (lastMoved && options.some(([p]) => p === lastMoved)) key.querySelector("select").value = lastMoved;
  key.onchange = fill;
  form.replaceChildren(element("div", { className: "row" }, kind, key), element("div", { className: "row" }, from, to, width, shownUnit, count, samples, goal, objective), element("div", { className: "row" }, ...speeds), element("div", { className: "row" }, ...pressures), element("div", { className: "row" }, speedsOfSupply, starts), element("div", { className: "row" }, ...loop), element("button", { className: "first", textContent: "Start the study" }), element("p", { className: "small", textContent: "Start-up needs a circuit with a pump that supplies it, hysteresis a floating bearing. Other studies: table “Study” under All keys, then Full run." }));
  const both = () => {
    const one = kind.querySelector("select").value, seen = (list, wanted) => { for (const box of list) box.hidden = !wanted; };
    seen([key, shownUnit], ["sweep", "optimise", "tolerance"].includes(one)); seen([speedsOfSupply, starts], one === "startup"); seen(loop, one === "hysteresis"); seen([from, to], one === "sweep" || one === "optimise"); seen([count], one === "sweep" || one === "efficiency_map");
    seen([width, samples], one === "tolerance"); seen([goal, objective], one === "optimise"); seen([...speeds, ...pressures], one === "efficiency_map");
  };
  kind.onchange = both; both(); fill();
  form.onsubmit = event => {
    event.preventDefault();
    const h = chosen(), data = new FormData(form), of = name => number(data.get(name)), a = fromShown(of("from"), h.unit), b = fromShown(of("to"), h.unit), n = Math.max(2, Math.round(of("count")));
    const value = v => written(h, Number(v.toPrecision(6))), bar = name => `${Number(fromShown(of(name), "bar").toPrecision(6))} bar`;
    const studies = {
      sweep: () => ({ kind: "sweep", vary: { [h.path]: Array.from({ length: n }, (_, k) => value(a + (b - a) * k / (n - 1))) } }),
      optimise: () => ({ kind: "optimise", objective: data.get("objective"), goal: data.get("goal"), vary: { [h.path]: { from: value(a), to: value(b) } } }),
      tolerance: () => ({ kind: "tolerance", sample_count: Math.max(2, Math.round(of("samples"))), vary: { [h.path]: { tolerance: value(of("tolerance") / factor(h.unit)) } } }),
      efficiency_map: () => ({ kind: "efficiency_map", shaft_speed: { from: `${of("slowest")} rpm`, to: `${of("fastest")} rpm`, count: n }, pressure_difference: { from: bar("lowest"), to: bar("highest"), count: n } }),
      startup: () => ({ kind: "startup", plateau_speed: data.get("plateaus").split(/[;\s]+/).filter(Boolean).map(v => `${number(v)} rpm`), start_angle_count: Math.max(1, Math.round(of("starts"))) }),
      hysteresis: () => {
        const [low, high] = [of("least"), of("most")].map(p => fromShown(p, "bar")), count = Math.max(1, Math.round(of("steps"))), up = Array.from({ length: count + 1 }, (_, k) => `${Number((low + (high - low) * k / count).toPrecision(6))} bar`);
        return { kind: "hysteresis", outlet_pressures: [...up, ...up.slice(0, -1).reverse()], start_gap: `${of("gap")} um`, friction_coefficient: of("friction"), breakaway_speed: "1.6 mm/s" };
      },
    };
    startRun("study", { study: studies[data.get("kind")]() });
  };
}

// ---- turning, tabs, keyboard, events -----------------------------------------------------------
function turnTo(angle, own = false) {
  machine.angle = angle; by("angle").value = angle; by("angle-shown").textContent = `${text(angle, 4)}°`; machine.draw();
  if (own) curves.cursor(angle);
  if (!by("panel-views").hidden) document.dispatchEvent(new CustomEvent("toothspace-cursor", { detail: { over: "shaft_angle", value: angle, from: machine } }));
}
function play(now) { if (!playing) return; if (playing.last) turnTo((machine.angle + (now - playing.last) * 0.012) % 360, true); playing.last = now; requestAnimationFrame(play); }
function stopPlaying() { playing = 0; by("play").setAttribute("aria-pressed", "false"); by("play").textContent = "Turn"; }
by("play").onclick = async () => { if (playing) return stopPlaying(); if (!machine.turning) { say("drawing the turning machine …"); await fetchTurning(); say(""); } playing = { last: 0 }; by("play").setAttribute("aria-pressed", "true"); by("play").textContent = "Hold"; requestAnimationFrame(play); };
by("angle").oninput = () => turnTo(Number(by("angle").value), true);
by("colour").onchange = () => { machine.colour = by("colour").value; machine.legend(); machine.draw(); };
by("arrows").onchange = () => { machine.arrows = by("arrows").checked; machine.draw(); };
by("search").oninput = () => shape && dimensions();
function choose(name) {
  for (const [one] of TABS) by(`panel-${one}`).hidden = one !== name;
  for (const tab of by("tabs").children) tab.setAttribute("aria-selected", tab.dataset.name === name);
  if (name === "geometry" && shape) { geometryBefore ??= shape.numbers; geometry(); if (!shape.cells) attempt(() => look({}, false)); }
  if (name === "circuit") showCircuit();
  if (name === "views") attempt(async () => { await loadRuns(); await showViews(); });
  if (name === "keys") showKeys();
  if (name === "text") showText();
  if (name === "variants") showVariants();
  if (name === "runs") { attempt(loadRuns); studyForm(); }
}
by("tabs").append(...TABS.map(([name, label]) => { const tab = element("button", { type: "button", textContent: label, onclick: () => choose(name) }); tab.dataset.name = name; tab.setAttribute("role", "tab"); return tab; }));
by("variant-form").onsubmit = event => { event.preventDefault(); variant({ action: "keep", label: by("variant-name").value, numbers: answer?.version === design.version ? answer.numbers : {} }); by("variant-name").value = ""; };
by("text-apply").onclick = () => change({ toml: by("text").value });
by("text-reset").onclick = () => showText();
for (const button of document.querySelectorAll("[data-run]")) button.onclick = () => startRun(button.dataset.run);
const undo = again => attempt(async () => { take(await ask(`/api/designs/${design.id}/undo`, { again })); solve(); await look({}, false); });
by("undo").onclick = () => undo(false); by("redo").onclick = () => undo(true);
addEventListener("keydown", event => { if ((event.ctrlKey || event.metaKey) && event.key.toLowerCase() === "z" && design && !["INPUT", "TEXTAREA"].includes(document.activeElement.tagName)) { event.preventDefault(); undo(event.shiftKey); } });
// units of measured columns by curve
const MEASURED = { chamber: "bar", outlet: "bar", flow: "L/min", torque: "N m" };
by("measured").onchange = async event => {
  const [file] = event.target.files; if (!file) return;
  const rows = (await file.text()).split(/\r?\n/).map(line => line.split(/[;\t]|,(?!\d+[;\t])/).map(number)).filter(r => r.length > 1 && r.every(Number.isFinite)).sort((a, b) => a[0] - b[0]);
  const name = by("measured-of").value, unit = MEASURED[name];
  if (rows.length < 2) { complain(new Error(`The measurement needs two columns: shaft angle in degrees, and values in ${unit}.`)); return; }
  measured[name] = x => x.map(a => { const k = rows.findIndex(r => r[0] >= a); if (k <= 0) return k === 0 && rows[0][0] === a ? toShown(rows[0][1], unit) : null; const [p, q] = [rows[k - 1], rows[k]]; return toShown(p[1] + (q[1] - p[1]) * (a - p[0]) / (q[0] - p[0]), unit); });
  event.target.value = "";
  if (answer) showAnswer();
};
by("settings-open").onclick = () => { settingsForm(by("settings-form"), () => { document.documentElement.dataset.theme = units.theme; for (const set of [curves, areas]) { set.box.replaceChildren(); set.plots.clear(); } if (design && shape) { dimensions(); geometry(); live(); machine.legend(); machine.fit(); } if (answer) { showAnswer(); showVariants(); showViews(); } }); by("settings").showModal(); };
document.documentElement.dataset.theme = units.theme;

const events = new EventSource("/api/events");
events.onmessage = ({ data }) => {
  const { kind, value } = JSON.parse(data);
  if (kind === "run") { runsTold += 1; runs = [value, ...runs.filter(r => r.id !== value.id)].sort((a, b) => b.begun - a.begun); if (design && !by("panel-runs").hidden) showRuns(); }
  if (kind === "answer" && value.design === design?.id && !by("stop").hidden) say(`${value.text} …`);
  // another tab has changed this design
  if (kind === "design" && value.id === design?.id && value.version > design.version && !machine.held) changing = changing.then(async () => { if (value.version <= design.version) return; take(await ask(`/api/designs/${design.id}`)); solve(); await look({}, false); });
};
async function route() {
  const id = location.hash.slice(1);
  if (/^[0-9a-f]{12}$/.test(id)) return open(id);
  stopPlaying(); design = null; by("title").textContent = ""; say("");
  by("bench").hidden = true; by("start").hidden = false; by("design-tools").hidden = true;
  await attempt(() => showStart(open));
}
addEventListener("hashchange", route);
keepWords(await attempt(() => ask("/api/words")) ?? { names: {}, beginnings: {} });
route();
