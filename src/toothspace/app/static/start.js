// Where one begins: by a question, by a machine, from a case, from CAD files, from a former design.
import { ask, by, complain, element } from "./dom.js";
import { named, number, text, toShown, unitShown } from "./units.js";

const QUESTIONS = [
  ["Size a pump", "Displacement, pressure and speed give a first design by the design rules.", { dialog: "new" }],
  ["Quiet a pump", "Move grooves and port edges, watch peak, ripple and cavitation.", { case: "egm12_pump" }],
  ["Start a motor", "From rest against its load: breakaway pressure, friction, speed.", { case: "startup_fan_drive" }],
  ["Check my CAD", "Drop STEP, STL, DXF or point files: what was found, then a running pump.", { dialog: "cad" }],
  ["Balance a bushing", "Floating bearing between lateral films: gap, tilt, leakage.", { case: "fuel14_pump" }],
];
const MACHINES = [["external_gear", "External gear pump or motor", "egm12_pump"], ["gerotor", "Gerotor", "gerotor_trochoidal"], ["crescent", "Internal gear pump with crescent", "crescent_pump"]];

export async function showStart(open) {
  const found = await ask("/api/start");
  const begin = given => attempt(async () => open((await ask("/api/designs", given)).id));
  by("questions").replaceChildren(...QUESTIONS.map(([title, about, what]) => card(title, about, () => what.dialog === "new" ? newDialog(found.new, begin) : what.dialog === "cad" ? cadDialog(begin) : begin(what))));
  by("machines").replaceChildren(...MACHINES.map(([name, title, example]) => card(title, "", () => begin({ case: example }), `/static/${name}.svg`)));
  by("designs").replaceChildren(...(found.designs.length ? found.designs.map(one => element("li", {},
    element("button", { textContent: one.title || "untitled", onclick: () => open(one.id) }), element("small", { className: "small", textContent: new Date(1000 * one.changed).toLocaleString() }),
    element("button", { textContent: "✕", title: "Delete this design", ariaLabel: `Delete ${one.title}`, onclick: async () => { if (confirm(`Delete “${one.title}”?`)) { await ask(`/api/designs/${one.id}`, undefined, { method: "DELETE" }); showStart(open); } } }))) : [element("li", { className: "small", textContent: "none yet" })]));
  const list = () => by("cases").replaceChildren(...found.cases.filter(c => `${c.name} ${c.title}`.toLowerCase().includes(by("case-search").value.toLowerCase())).map(c => element("li", {},
    element("button", { onclick: () => begin({ case: c.name }), title: c.name }, c.title || c.name), c.from ? element("small", { className: "small", textContent: `in ${c.from}` }) : null)));
  by("case-search").oninput = list; list();
}
const card = (title, about, onclick, picture) => element("button", { className: "card", type: "button", onclick }, picture ? element("img", { src: picture, alt: "" }) : null, element("b", { textContent: title }), about ? element("span", { className: "small", textContent: about }) : null);
async function attempt(work) { complain(null); document.body.style.cursor = "progress"; try { await work(); } catch (error) { complain(error); } finally { document.body.style.cursor = ""; } }

export function newDialog(machines, begin) {
  const form = by("new-form"), field = (name, label, value, unit) => element("label", {}, label, element("span", { className: "value" }, element("input", { name, type: "text", value: text(toShown(value, unit)), required: true }), element("span", { textContent: unitShown(unit) })));
  const machine = element("select", { name: "machine" }, ...machines.map(name => element("option", { value: name, textContent: name.replace(/_/g, " ") })));
  machine.value = "external_gear";
  machine.onchange = () => { form.elements.pressure.value = text(toShown(machine.value === "gerotor" ? 60 : 210, "bar")); };
  form.replaceChildren(element("h2", { textContent: "Size a pump" }), element("label", {}, "Machine", machine), field("displacement", "Displacement per turn", 14, "cm^3"), field("pressure", "Outlet pressure", 210, "bar"), field("speed", "Speed", 1500, "rpm"),
    element("p", { className: "small", textContent: "Teeth, face width, bearings, clearances, ports and grooves follow from the design rules." }),
    element("div", { className: "row" }, element("button", { className: "first", value: "ok", textContent: "Design it" }), element("button", { value: "no", textContent: "Cancel", formNoValidate: true })));
  form.onsubmit = event => {
    if (event.submitter?.value !== "ok") return;
    const data = new FormData(form), pressure = (number(data.get("pressure")) / toShown(1, "bar"));
    begin({ new: { machine: data.get("machine"), displacement: `${number(data.get("displacement"))} cm^3`, pressure: `${pressure} bar`, speed: `${number(data.get("speed"))} rpm` } });
  };
  by("new-dialog").showModal();
}

export function cadDialog(begin) {
  const box = by("cad"), names = [];
  const unit = element("select", {}, ...["mm", "in", "m", "um"].map(u => new Option(u)));
  const files = element("ul", { className: "small" }), found = element("div");
  const input = element("input", { type: "file", multiple: true, accept: ".step,.stp,.stl,.dxf,.txt,.csv,.toml" });
  const take = list => attempt(async () => {
    for (const file of list) { const { name } = await ask(`/api/files/${encodeURIComponent(file.name)}`, undefined, { method: "PUT", body: file }); if (!name.endsWith(".toml")) names.push(name); else await begin({ case: name }); files.append(element("li", { textContent: name })); }
    if (names.length) await read();
  });
  const leftOut = new Map();
  const read = () => attempt(async () => {
    found.setAttribute("aria-busy", "true"); if (!found.childElementCount) found.replaceChildren("Reading …");
    const told = await ask("/api/found", { names, unit: unit.value, left_out: [...leftOut.values()] });
    const guessed = told.toml.split("\n").filter(line => /assumed/.test(line) && !line.startsWith("#"));
    found.removeAttribute("aria-busy");
    found.replaceChildren(bodiesDrawing(told.bodies, leftOut, read), element("div", { className: "beside" },
      element("section", {}, element("h3", { textContent: "Found" }), reportTable(told.report)),
      element("section", {}, element("h3", { textContent: "Guessed: put in your own" }), guessed.length ? guessTable(guessed) : element("p", { className: "small", textContent: told.toml ? "Nothing." : "No machine yet." }))),
      ...told.warnings.map(w => element("p", { className: "bad small", textContent: w })), told.problem ? element("p", { className: "bad", textContent: told.problem }) : "");
    if (!told.toml) return;
    const area = element("textarea", { value: told.toml, rows: 14, spellcheck: false, ariaLabel: "First case" });
    found.append(element("h3", { textContent: "First case" }), area,
      element("div", { className: "row" }, element("button", { className: "first", textContent: "Open on the bench", onclick: () => { by("cad-dialog").close(); begin({ toml: area.value }); } })));
  });
  input.onchange = () => take(input.files); unit.onchange = () => names.length && read();
  box.replaceChildren(element("h2", { textContent: "Check my CAD" }), element("p", { className: "small", textContent: "Gears, rotors, casing and bearing blocks of one frame. Files are kept in the folder of this session." }), element("div", { className: "row" }, input, element("label", { style: "display:flex" }, "Unit ", unit)), files, found, element("div", { className: "row" }, element("button", { textContent: "Close", onclick: () => by("cad-dialog").close() })));
  box.ondragover = event => event.preventDefault(); box.ondrop = event => { event.preventDefault(); take(event.dataTransfer.files); };
  by("cad-dialog").showModal();
}
// bodies of solid files in one section: a click takes one out of the machine, or back in
function bodiesDrawing(bodies, leftOut, changed) {
  const box = element("div");
  if (bodies.length < 2) return box;
  const key = b => `${b.file} ${b.body}`, points = bodies.flatMap(b => b.outlines.flat()), x = points.map(p => p[0]), y = points.map(p => p[1]);
  const [l, r, low, high] = [Math.min(...x), Math.max(...x), Math.min(...y), Math.max(...y)], room = .04 * Math.max(r - l, high - low);
  const make = (kind, attributes) => { const e = document.createElementNS("http://www.w3.org/2000/svg", kind); for (const [n, v] of Object.entries(attributes)) e.setAttribute(n, v); return e; };
  const drawing = make("svg", { class: "bodies", viewBox: `${l - room} ${-high - room} ${r - l + 2 * room} ${high - low + 2 * room}`, role: "group", "aria-label": "Bodies in the files" });
  const area = b => { const o = b.outlines[0] ?? []; let sum = 0; o.forEach((p, k) => { const q = o[(k + 1) % o.length]; sum += p[0] * q[1] - q[0] * p[1]; }); return Math.abs(sum); };
  const list = element("ul", { className: "small list" }), toggle = b => { if (leftOut.has(key(b))) leftOut.delete(key(b)); else leftOut.set(key(b), [b.file, b.body]); changed(); };
  const called = b => `${b.name || `body ${b.body + 1}`} (${b.file}): ${b.teeth ? `${b.kind} of ${b.teeth} teeth` : "no teeth"}`;
  for (const b of [...bodies].sort((p, q) => area(q) - area(p))) {
    const out = leftOut.has(key(b)), path = make("path", { d: b.outlines.map(o => `M${o.map(([p, q]) => `${p} ${-q}`).join("L")}Z`).join(""), class: `body ${b.teeth ? "teeth" : ""} ${out ? "out" : ""}`, tabindex: 0, role: "checkbox", "aria-checked": !out, "aria-label": called(b) });
    path.dataset.body = key(b);
    path.append(Object.assign(make("title", {}), { textContent: `${called(b)}. Click to ${out ? "take it in" : "leave it out"}.` }));
    path.addEventListener("click", () => toggle(b)); path.addEventListener("keydown", event => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); toggle(b); } });
    drawing.append(path);
  }
  for (const b of bodies) { const tick = element("input", { type: "checkbox", checked: !leftOut.has(key(b)) }); tick.onchange = () => toggle(b); list.append(element("li", {}, element("label", { style: "display:flex" }, tick, called(b)))); }
  box.append(element("h3", { textContent: "Bodies: click those that do not belong to the machine" }), drawing, list);
  return box;
}
function guessTable(lines) {
  return element("table", {}, ...lines.map(line => { const [given, note = ""] = line.split("#"), [name, value = ""] = given.split("="); return element("tr", { title: name.trim() }, element("td", { textContent: name.trim().replace(/_/g, " ") }), element("td", { textContent: value.trim().replace(/^"|"$/g, "") }), element("td", { textContent: note.trim() })); }));
}
function reportTable(report) {
  const rows = [], walk = (value, path) => {
    if (value === null) return;
    if (Array.isArray(value)) value.forEach((v, k) => walk(v, `${path} ${k + 1}`));
    else if (typeof value === "object") for (const [k, v] of Object.entries(value)) walk(v, path ? `${path}: ${k}` : k);
    else rows.push([path, value]);
  };
  walk(report, "");
  return element("div", { className: "scroll scroll-x" }, element("table", {}, ...rows.map(([path, value]) => { const last = path.split(": ").at(-1), { label, unit } = named(last); return element("tr", {}, element("td", { textContent: path.replace(last, label).replace(/_/g, " ") }), element("td", { textContent: typeof value === "number" ? `${text(value, 5)} ${unitShown(unit)}` : value })); })));
}
