// The machine, drawn to scale from its tables: a canvas for metal and fluid, handles above it.
import { by } from "./dom.js";
import { text, toShown, unitShown } from "./units.js";

const STOPS = [[0, 34, 78], [53, 69, 108], [102, 105, 112], [148, 142, 119], [200, 184, 102], [254, 232, 56]];
const GAS = [[240, 244, 248], [190, 220, 240], [120, 180, 220], [60, 130, 190], [20, 80, 150], [0, 34, 90]];
const LEAKS = [[247, 244, 240], [253, 219, 180], [250, 170, 100], [224, 104, 30], [160, 54, 3], [80, 20, 0]];
let theme = "", cached = {};
function css(name) {
  if (theme !== document.documentElement.dataset.theme) { theme = document.documentElement.dataset.theme; cached = {}; }
  return cached[name] ??= getComputedStyle(document.documentElement).getPropertyValue(name).trim();
}
function colourOf(share, stops = STOPS) {
  const at = Math.min(Math.max(share, 0), 1) * (stops.length - 1), k = Math.min(Math.floor(at), stops.length - 2), f = at - k;
  return `rgb(${stops[k].map((c, i) => Math.round(c + f * (stops[k + 1][i] - c))).join(",")})`;
}

export class Machine {
  constructor(onHold, onMove, onRelease) {
    Object.assign(this, { onHold, onMove, onRelease, section: null, turning: null, angle: 0, colour: "pressure", arrows: true, handles: [], frames: [] });
    this.canvas = by("canvas"); this.svg = by("handles"); this.held = null;
    new ResizeObserver(() => this.fit()).observe(by("picture"));
  }
  show(section, handles, fit = true) {
    this.section = section;
    this.paths = section.bodies.map(body => ring2path(body.outline));
    this.recesses = Object.values(section.recesses).map(outline => ring2path([outline]));
    this.fixed = { housing: ring2path(section.housing), solid: ring2path(section.fixed), inlet: ring2path(section.ports.inlet), outlet: ring2path(section.ports.outlet) };
    this.rest = section.cells.map(ring2path);
    if (handles) { this.handles = handles; }
    if (fit || !this.box) this.measure();
    this.placeHandles(); this.draw();
  }
  turn(turning) {
    this.turning = turning && turning.cells.length ? { ...turning, paths: turning.cells.map(cells => cells.map(ring2path)) } : null;
    if (this.turning) {
      const ports = [...turning.ports.inlet, ...turning.ports.outlet];
      this.top = Math.max(Math.min(Math.max(...turning.pressure.flat()), 1.5 * Math.max(...ports)), 1);
      this.leakTop = Math.max(1e-6, ...(turning.leakage ?? [[]]).flat());
      this.forceTop = Math.max(1, ...Object.values(turning.forces ?? {}).flat().map(([x, y]) => Math.hypot(x, y)));
    }
    this.legend(); this.draw();
  }
  // what follows a handle at once, before the tables are made anew
  preview(handle) {
    const s = this.section, moved = (handle.now ?? handle.value) - handle.value, name = handle.path.split(".").at(-1), p = handle.place;
    if (!s || !p || handle.drawn === moved) return;
    const step = moved - (handle.drawn ?? 0); handle.drawn = moved;
    const shift = p.kind === "line" ? p.direction.map(d => d * step) : [0, 0];
    if (/offset$|^width$|^radial_extent$/.test(name)) {
      for (const outline of Object.values(s.recesses)) {
        if (outline.length > 6) continue;
        const side = Math.sign(outline.reduce((sum, q) => sum + q[0], 0)), x = outline.map(q => q[0] * side), y = outline.map(q => q[1]), far = Math.max(...x), middle = (Math.max(...y) + Math.min(...y)) / 2;
        const own = name === "width" || name === "radial_extent" || side === Math.sign(p.point[0]);
        if (!own) continue;
        for (const q of outline) {
          if (name === "radial_extent") q[1] += Math.sign(q[1] - middle) * shift[1];
          else if (name === "width") { if (Math.abs(q[0] * side - far) < 1e-6) q[0] += side * Math.abs(shift[0]) * Math.sign(step); }
          else q[0] += shift[0];
        }
      }
      this.recesses = Object.values(s.recesses).map(outline => ring2path([outline]));
    } else if (name === "center_distance") s.bodies[1].center = s.bodies[1].center.map((c, i) => c + shift[i]);
    for (const part of s.side ?? []) (part.moves[handle.path] ?? []).forEach((d, k) => { part.edges[k] += d * step; });
    if (name === "diameter") for (const body of s.bodies) if (body.journal) body.journal += 2 * Math.hypot(...shift) * Math.sign(step);
    this.draw();
  }
  // bodies whose outlines are closed forms
  follow({ teeth, rotors, outlines, centers }) {
    const bodies = this.section.bodies;
    centers.forEach((center, k) => { if (center && bodies[k]) bodies[k].center = center; });
    outlines().forEach((outline, k) => {
      const body = bodies[k];
      if (!body) return;
      if (rotors && k) { body.outline = [body.outline[0], outline]; this.paths[k] = ring2path(body.outline); return; }
      const a = rotors ? 0 : body.phase ??= phaseOf(body.outline[0], teeth[k]), [c, s] = [Math.cos(a), Math.sin(a)];
      this.paths[k] = ring2path([outline.map(([x, y]) => [x * c - y * s, x * s + y * c]), ...body.outline.slice(1)]);
    });
    this.draw();
  }
  measure() {
    const side = this.section.side.flatMap(({ edges: [l, r, b, t] }) => [[l, b], [r, t]]), points = this.section.housing.flat(), ports = Object.values(this.section.ports).flatMap(r => r.flat()); points.push(...side, ...ports);
    const x = points.map(p => p[0]), y = points.map(p => p[1]);
    this.box = [Math.min(...x), Math.min(...y), Math.max(...x), Math.max(...y)];
    this.fit();
  }
  fit() {
    const { clientWidth: w, clientHeight: h } = this.canvas;
    if (!w || !this.box) return;
    const ratio = devicePixelRatio || 1, [l, b, r, t] = this.box, room = 18, scale = this.section.side.length ? 54 : 0; // room for the scale of colours
    this.canvas.width = w * ratio; this.canvas.height = h * ratio;
    this.k = Math.min((w - 2 * room - scale) / (r - l), (h - 2 * room) / (t - b));
    this.ox = (w - scale) / 2 - this.k * (l + r) / 2; this.oy = h / 2 + this.k * (b + t) / 2; this.ratio = ratio;
    this.svg.setAttribute("viewBox", `0 0 ${w} ${h}`);
    this.placeHandles(); this.draw();
  }
  screen([x, y]) { return [this.ox + this.k * x, this.oy - this.k * y]; }
  draw() {
    if (!this.asked) this.asked = requestAnimationFrame(now => { this.asked = 0; const began = performance.now(); this.paint(); this.frames.push({ at: now, paint: performance.now() - began }); if (this.frames.length > 240) this.frames.shift(); });
  }
  paint() {
    const s = this.section;
    if (!s || !this.k) return;
    const g = this.canvas.getContext("2d"), t = this.turning, frames = t?.paths.length ?? 0;
    g.setTransform(1, 0, 0, 1, 0, 0); g.clearRect(0, 0, this.canvas.width, this.canvas.height);
    g.setTransform(this.ratio * this.k, 0, 0, -this.ratio * this.k, this.ratio * this.ox, this.ratio * this.oy);
    const thin = 1 / this.k, ink = css("--ink"), wall = css("--wall");
    const fill = (path, colour, line, width = thin) => { if (colour) { g.fillStyle = colour; g.fill(path, "evenodd"); } if (line) { g.strokeStyle = line; g.lineWidth = width; g.stroke(path); } };
    const pitch = s.pitch, turned = this.angle * Math.PI / 180;
    const share = ((turned % pitch) + pitch) % pitch / pitch, frame = frames ? Math.floor(share * frames) % frames : 0;
    // seen frames stand for all angles: after one pitch the machine looks the same
    const shaft = frames ? t.shaft[frame] : 0;
    fill(this.fixed.housing, wall, css("--soft"));
    const port = name => t && this.colour === "pressure" ? colourOf(t.ports[name][frame] / this.top) : name === "inlet" ? "rgba(0,114,178,.35)" : "rgba(213,94,0,.45)";
    fill(this.fixed.inlet, port("inlet")); fill(this.fixed.outlet, port("outlet"));
    const values = t?.[this.colour]?.[frame], scale = this.scale();
    (t ? t.paths[frame] : this.rest).forEach((path, k) => {
      const colour = values ? colourOf(values[k] / scale.top, scale.stops) : css("--sheet");
      fill(path, colour, colour, .5 * thin);
    });
    s.bodies.forEach((body, k) => {
      g.save(); g.translate(...body.center); g.rotate(body.ratio * shaft);
      fill(this.paths[k], css("--metal"), ink); g.restore();
      g.beginPath(); g.strokeStyle = ink; g.lineWidth = thin; g.setLineDash([]);
      if (body.journal) { g.arc(...body.center, body.journal / 2, 0, 7); g.stroke(); }
      g.beginPath(); g.moveTo(body.center[0] - 6 * thin, body.center[1]); g.lineTo(body.center[0] + 6 * thin, body.center[1]); g.moveTo(body.center[0], body.center[1] - 6 * thin); g.lineTo(body.center[0], body.center[1] + 6 * thin); g.stroke();
    });
    fill(this.fixed.solid, wall, ink);
    g.setLineDash([6 * thin, 4 * thin]);
    for (const path of this.recesses) fill(path, null, css("--accent"), 1.6 * thin);
    g.setLineDash([]);
    this.paintSide(g, fill, thin);
    if (this.arrows && t?.forces) s.bodies.forEach(body => this.arrow(g, body, t.forces[body.name]?.[frame], thin));
  }
  // a cut along the axis, beside the section
  paintSide(g, fill, thin) {
    const { side } = this.section, colours = { wall: css("--wall"), metal: css("--metal"), gap: css("--sheet"), groove: css("--sheet") };
    for (const { kind, edges: [l, r, b, t] } of side) { const path = new Path2D(); path.rect(l, b, r - l, t - b); fill(path, colours[kind], kind === "groove" ? css("--accent") : css("--soft"), thin); }
  }
  arrow(g, body, force, thin) {
    if (!force) return;
    const size = Math.hypot(...force), reach = .45 * Math.min(this.box[2] - this.box[0], this.box[3] - this.box[1]) * .5;
    if (size < .02 * this.forceTop) return;
    const [x, y] = body.center, dx = force[0] / this.forceTop * reach, dy = force[1] / this.forceTop * reach, a = Math.atan2(dy, dx), head = 9 * thin;
    g.strokeStyle = g.fillStyle = css("--two"); g.lineWidth = 3 * thin;
    g.beginPath(); g.moveTo(x, y); g.lineTo(x + dx, y + dy); g.stroke();
    g.beginPath(); g.moveTo(x + dx + head * Math.cos(a), y + dy + head * Math.sin(a));
    for (const side of [2.5, -2.5]) g.lineTo(x + dx + head * Math.cos(a + side), y + dy + head * Math.sin(a + side));
    g.fill();
  }
  legend() {
    const box = by("scale"); box.replaceChildren();
    if (!this.turning) return;
    const { top, stops, unit } = this.scale(), bar = document.createElement("div");
    if (!this.turning[this.colour]) { box.append("not known for this answer"); return; }
    bar.className = "bar";
    bar.style.background = `linear-gradient(to top, ${[0, .2, .4, .6, .8, 1].map(x => colourOf(x, stops)).join(",")})`;
    box.append(`${text(toShown(top, unit), 3)} ${unitShown(unit)}`, bar, `0 ${unitShown(unit)}`);
  }
  scale() {
    return { pressure: { top: this.top, stops: STOPS, unit: "bar" }, gas: { top: 20, stops: GAS, unit: "%" }, leakage: { top: this.leakTop, stops: LEAKS, unit: "L/min" } }[this.colour];
  }
  // handles
  placeHandles() {
    if (!this.k) return;
    const seen = new Set();
    for (const handle of this.handles) {
      if (!handle.place) continue;
      seen.add(handle.path);
      let group = this.svg.querySelector(`[data-path="${CSS.escape(handle.path)}"]`);
      if (!group) this.svg.append(group = this.newHandle(handle.path));
      this.putHandle(group, handle);
    }
    for (const group of [...this.svg.children]) if (!seen.has(group.dataset.path)) group.remove();
  }
  position(handle) {
    const p = handle.place, moved = (handle.now ?? handle.value) - handle.value;
    if (p.kind === "arc") { const a = p.zero + p.turn * (handle.now ?? handle.value); return [p.center[0] + p.radius * Math.cos(a), p.center[1] + p.radius * Math.sin(a)]; }
    return [p.point[0] + moved * p.direction[0], p.point[1] + moved * p.direction[1]];
  }
  putHandle(group, handle) {
    const [x, y] = this.screen(this.position(handle)), value = handle.now ?? handle.value, right = x > this.canvas.clientWidth * .6;
    group.setAttribute("transform", `translate(${x},${y})`);
    group.setAttribute("aria-valuenow", value); group.setAttribute("aria-valuemin", handle.low); group.setAttribute("aria-valuemax", handle.high);
    group.setAttribute("aria-label", handle.label); group.setAttribute("aria-valuetext", `${text(toShown(value, handle.unit))} ${unitShown(handle.unit)}`);
    const label = group.querySelector("text");
    label.textContent = `${handle.label}: ${text(toShown(value, handle.unit))} ${unitShown(handle.unit)}${handle.place.times > 1 ? `, drawn ${handle.place.times} times its size` : ""}`;
    label.setAttribute("x", right ? -12 : 12); label.setAttribute("text-anchor", right ? "end" : "start"); label.setAttribute("y", -9);
    const line = group.querySelector("line"), p = handle.place, across = p.kind === "line" && Math.abs(p.direction[0]) > Math.abs(p.direction[1]);
    const l = .22 * this.canvas.clientHeight;
    for (const [name, v] of Object.entries(across ? { x1: 0, x2: 0, y1: -l, y2: l } : { x1: -l, x2: l, y1: 0, y2: 0 })) line.setAttribute(name, p.kind === "arc" ? 0 : v);
  }
  newHandle(path) {
    const make = (kind, attributes) => { const e = document.createElementNS("http://www.w3.org/2000/svg", kind); for (const [n, v] of Object.entries(attributes)) e.setAttribute(n, v); return e; };
    const group = make("g", { class: "handle", tabindex: 0, role: "slider" });
    group.dataset.path = path;
    group.append(make("line", {}), make("circle", { r: 16, style: "fill:transparent;stroke:none" }), make("circle", { r: 6.5 }), make("text", {}));
    const find = () => this.handles.find(h => h.path === path);
    group.addEventListener("pointerdown", event => {
      event.preventDefault(); group.setPointerCapture(event.pointerId); group.classList.add("held"); group.focus();
      const handle = find(), box = this.svg.getBoundingClientRect();
      this.held = { handle, group, box, from: handle.value, at: this.toMm(event, box) }; this.onHold(handle);
    });
    group.addEventListener("pointermove", event => {
      if (this.held?.group !== group) return;
      this.onMove(this.held.handle, this.valueAt(this.held, this.toMm(event, this.held.box)));
    });
    const release = () => { if (this.held?.group === group) { group.classList.remove("held"); const { handle } = this.held; this.held = null; this.onRelease(handle); } };
    group.addEventListener("pointerup", release); group.addEventListener("pointercancel", release);
    group.addEventListener("lostpointercapture", release);
    group.addEventListener("keydown", event => {
      const handle = find(), step = (handle.whole ? 1 : (handle.high - handle.low) / 200) * (event.shiftKey ? 10 : 1);
      const sign = { ArrowRight: 1, ArrowUp: 1, ArrowLeft: -1, ArrowDown: -1 }[event.key];
      if (!sign) return;
      event.preventDefault(); this.onMove(handle, this.bounded(handle, (handle.now ?? handle.value) + sign * step)); this.onRelease(handle);
    });
    return group;
  }
  toMm(event, box) { return [(event.clientX - box.left - this.ox) / this.k, (this.oy - event.clientY + box.top) / this.k]; }
  valueAt({ handle, from, at }, [x, y]) {
    const p = handle.place;
    if (p.kind === "arc") {
      let turned = Math.atan2(y - p.center[1], x - p.center[0]) - p.zero;
      const full = 2 * Math.PI; turned = p.turn > 0 ? (turned % full + full) % full : (turned % full - full) % full;
      return this.bounded(handle, turned / p.turn);
    }
    const [dx, dy] = p.direction, moved = ((x - at[0]) * dx + (y - at[1]) * dy) / (dx * dx + dy * dy);
    return this.bounded(handle, from + moved);
  }
  bounded(handle, value) {
    const kept = Math.min(Math.max(value, handle.low), handle.high);
    return handle.whole ? Math.round(kept) : Number(kept.toPrecision(5));
  }
}
// angle of a tooth, from the middles of the tip lands
function phaseOf(outline, count) {
  const far = Math.max(...outline.map(p => Math.hypot(...p))), tips = outline.filter(p => Math.hypot(...p) > .9995 * far).map(([x, y]) => count * Math.atan2(y, x));
  return Math.atan2(tips.reduce((sum, a) => sum + Math.sin(a), 0), tips.reduce((sum, a) => sum + Math.cos(a), 0)) / count;
}
function ring2path(rings) {
  const path = new Path2D();
  for (const ring of rings) { ring.forEach(([x, y], k) => k ? path.lineTo(x, y) : path.moveTo(x, y)); path.closePath(); }
  return path;
}
