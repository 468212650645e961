// The circuit as a diagram, with the values of the chosen element at hand; fidelity and what it costs.
import { element } from "./dom.js";

const SVG = "http://www.w3.org/2000/svg", WIDE = 118, TALL = 40, GAP_X = 70, GAP_Y = 26;
const make = (kind, attributes, ...children) => { const e = document.createElementNS(SVG, kind); for (const [k, v] of Object.entries(attributes)) e.setAttribute(k, v); e.append(...children); return e; };
const words = name => { const t = name.replace(/_/g, " "); return t[0].toUpperCase() + t.slice(1); };

// nodes of the drawing and the wires between them, from the tables of a case
export function parts(tables) {
  const machine = { name: "machine", kind: words(tables.machine?.type ?? "machine"), place: null };
  const found = new Map([["machine", machine]]), wires = [], shafts = [];
  const circuit = tables.circuit;
  if (circuit) {
    for (const [name, values] of Object.entries(circuit)) if (values?.kind) found.set(name, { name, kind: words(values.kind), values, path: `circuit.${name}` });
    for (const [a, b] of circuit.connections ?? []) wires.push([a, b]);
    const wired = new Set(wires.flat().map(end => end.split(".")[0]));
    for (const name of found.keys()) if (name !== "machine" && !wired.has(name)) shafts.push(name);
  } else if (tables.operating_point) {
    const point = tables.operating_point, path = "operating_point";
    found.set("inlet", { name: "inlet", kind: "Held pressure", values: { inlet_pressure: point.inlet_pressure }, path });
    wires.push(["inlet", "machine.inlet"]);
    if (point.outlet_load === "orifice") {
      found.set("load", { name: "load", kind: "Sized orifice", values: { outlet_pressure: point.outlet_pressure, outlet_load: point.outlet_load }, path });
      wires.push(["machine.outlet", "load"]);
    } else {
      found.set("outlet", { name: "outlet", kind: "Held pressure", values: { outlet_pressure: point.outlet_pressure }, path });
      wires.push(["machine.outlet", "outlet"]);
    }
    found.set("drive", { name: "drive", kind: "Held speed", values: { shaft_speed: point.shaft_speed }, path });
    shafts.push("drive");
  }
  return { found, wires, shafts };
}

export function drawCircuit(box, tables, change) {
  const { found, wires, shafts } = parts(tables), own = end => end.split(".")[0];
  // columns: as far from where the fluid comes from as the longest way without turning back
  const into = new Set(wires.map(w => own(w[1]))), columns = new Map();
  const visit = (name, level, seen) => { if (seen.has(name) || (columns.get(name) ?? -1) >= level) return; columns.set(name, level); for (const [a, b] of wires) if (own(a) === name) visit(own(b), level + 1, new Set([...seen, name])); };
  const sources = [...found.keys()].filter(name => !shafts.includes(name) && !into.has(name));
  for (const name of sources.length ? sources : ["machine"]) visit(name, 0, new Set());
  for (const name of found.keys()) if (!shafts.includes(name) && !columns.has(name)) columns.set(name, 0);
  const rows = new Map(), most = [];
  for (const [name, column] of [...columns].sort((a, b) => a[1] - b[1])) { rows.set(name, most[column] = (most[column] ?? -1) + 1); }
  const deep = Math.max(...most.map(m => (m ?? 0) + 1), 1), w = most.length * (WIDE + GAP_X) + 10, h = (deep + (shafts.length ? 1 : 0)) * (TALL + GAP_Y) + 20;
  const at = name => shafts.includes(name)
    ? [10 + (columns.get("machine") + shafts.indexOf(name) - (shafts.length - 1) / 2) * (WIDE + GAP_X), deep * (TALL + GAP_Y) + 14]
    : [10 + columns.get(name) * (WIDE + GAP_X), 10 + rows.get(name) * (TALL + GAP_Y)];
  const drawing = make("svg", { viewBox: `0 0 ${w} ${h}`, role: "group", "aria-label": "Circuit", style: `width:100%;max-width:${Math.round(w * 1.3)}px` });
  for (const [a, b] of wires) {
    const [x1, y1] = at(own(a)), [x2, y2] = at(own(b)), back = x2 <= x1, s = [x1 + (back ? WIDE / 2 : WIDE), y1 + (back ? TALL : TALL / 2)], e = [x2 + (back ? WIDE / 2 : 0), y2 + (back ? 0 : TALL / 2)];
    const middle = (s[0] + e[0]) / 2, line = back ? `M${s}V${(s[1] + e[1]) / 2}H${e[0]}V${e[1]}` : `M${s}H${middle}V${e[1]}H${e[0]}`;
    drawing.append(make("path", { d: line, fill: "none", stroke: "var(--one)", "stroke-width": 2 }));
    for (const [end, [x, y], side] of [[a, s, 4], [b, e, -4]]) if (end.includes(".")) { const label = make("text", { x: x + side, y: y - 4, "font-size": 9, fill: "var(--soft)", "text-anchor": side > 0 ? "start" : "end" }); label.textContent = end.split(".")[1]; drawing.append(label); }
  }
  for (const name of shafts) { const [x1, y1] = at(name), [x2, y2] = at("machine"); drawing.append(make("path", { d: `M${x1 + WIDE / 2} ${y1}L${x2 + WIDE / 2} ${y2 + TALL}`, stroke: "var(--two)", "stroke-width": 2, "stroke-dasharray": "5 4", fill: "none" })); }
  const detail = element("div", { className: "small", textContent: "Choose an element to see and change its values. Blue: oil; orange: shaft." });
  for (const one of found.values()) {
    const [x, y] = at(one.name), title = make("text", { x: WIDE / 2, y: 17, "text-anchor": "middle", "font-size": 12, "font-weight": 600, fill: "var(--ink)" }), kind = make("text", { x: WIDE / 2, y: 31, "text-anchor": "middle", "font-size": 10, fill: "var(--soft)" });
    title.textContent = words(one.name); kind.textContent = one.kind;
    const group = make("g", { transform: `translate(${x},${y})`, tabindex: 0, role: "button", "aria-label": `${one.name}: ${one.kind}`, style: "cursor:pointer" }, make("rect", { width: WIDE, height: TALL, rx: one.name === "machine" ? 20 : 5, fill: one.name === "machine" ? "var(--metal)" : "var(--sheet)", stroke: "var(--ink)" }), title, kind);
    group.dataset.element = one.name;
    const choose = () => detail.replaceChildren(...(one.values ? [element("h3", { textContent: `${words(one.name)}: ${one.kind}` }), ...Object.entries(one.values).filter(([key, v]) => key !== "kind" && v !== undefined).map(([key, v]) => field(one, key, v, change))] : [element("p", { textContent: "The machine: its dimensions are beside the drawing." })]));
    group.addEventListener("click", choose); group.addEventListener("keydown", event => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); choose(); } });
    drawing.append(group);
  }
  box.replaceChildren(drawing, detail);
}
function field(one, key, value, change) {
  const plain = typeof value === "string" || typeof value === "number", path = `${one.path}.${key}`;
  const input = element("input", { type: "text", value: plain ? value : JSON.stringify(value), title: path, ariaLabel: words(key) });
  input.onchange = () => { let given = input.value.trim(); if (!plain || typeof value === "number") try { given = JSON.parse(given); } catch { /* the server says what is wrong */ } change(path, given); };
  return element("label", { className: "key" }, element("span", { textContent: words(key), title: path }), input);
}

// presets, what each solves on every interface, and what a run of this design took with it
export function drawFidelity(box, fidelities, tables, took, change) {
  const present = tables.run?.fidelity ?? "lumped", given = tables.run?.interfaces ?? {};
  const seconds = name => took[name] ? `${took[name].toPrecision(2)} s measured here` : fidelities.costs[name];
  box.replaceChildren(
    ...fidelities.presets.map(p => { const radio = element("input", { type: "radio", name: "fidelity", checked: p.name === present }); radio.onchange = () => change("run.fidelity", p.name); return element("label", { className: "fidelity" }, radio, element("b", { textContent: words(p.name) }), element("span", { textContent: `${p.content} ` }), element("small", { textContent: seconds(p.name) })); }),
    element("h3", { textContent: "Model of each interface" }),
    ...Object.entries(fidelities.presets.find(p => p.name === present)?.interfaces ?? {}).map(([name, models]) => {
      const select = element("select", { ariaLabel: fidelities.interfaces[name] }, ...models.filter(m => m !== "table").map((m, k) => new Option(`${words(m)}${k ? "" : " (as the fidelity has it)"}`, m, false, m === (given[name] ?? models[0]))));
      select.disabled = models.length < 2 || !fidelities.free.includes(name);
      const about = element("small", { textContent: fidelities.models[select.value].replace(/`/g, "") });
      select.onchange = () => change(`run.interfaces.${name}`, select.value);
      return element("div", { className: "key" }, element("span", { textContent: fidelities.interfaces[name] }), select, about);
    }));
}
