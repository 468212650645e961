// Views of a result (see views.py): curves, spectra, orbits, films in plane and space, maps, losses.
// Plain canvas, no dependencies: the page, reports and notebooks load this file as it is.
(function () {
"use strict";
const STOPS = [[0, 34, 78], [53, 69, 108], [102, 105, 112], [148, 142, 119], [200, 184, 102], [254, 232, 56]];
const FALLBACK = { "--ink": "#1c2733", "--soft": "#5b6875", "--line": "#d5dce3", "--sheet": "#fff", "--one": "#0072b2", "--two": "#d55e00", "--three": "#009e73" };
const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim() || FALLBACK[name];
const mix = share => { const at = Math.min(Math.max(share, 0), 1) * 5, k = Math.min(Math.floor(at), 4), f = at - k; return STOPS[k].map((c, i) => Math.round(c + f * (STOPS[k + 1][i] - c))); };
const colour = (share, light = 1) => `rgb(${mix(share).map(c => Math.round(c * light)).join(",")})`;
const made = (kind, properties = {}, ...children) => { const e = Object.assign(document.createElement(kind), properties); e.append(...children.filter(c => c !== null)); return e; };
let shown = (value, unit) => [value, unit], text = (v, digits = 4) => v === null || v === undefined || !Number.isFinite(v) ? "–" : String(Number(v.toPrecision(digits)));
const told = (v, unit, digits) => { if (v === null || v === undefined) return "–"; const [w, u] = shown(v, unit); return `${text(w, digits)} ${u === "1" ? "" : u}`.trim(); };
const range = values => { let low = Infinity, high = -Infinity; for (const v of values) if (v !== null && v !== undefined) { if (v < low) low = v; if (v > high) high = v; } return low <= high ? [low, high] : [0, 1]; };
function ticks(low, high, most = 5) {
  const step = (high - low) / most || 1, power = 10 ** Math.floor(Math.log10(step)), unit = [1, 2, 5, 10].find(m => m * power >= step) * power, found = [];
  for (let v = Math.ceil(low / unit) * unit; v <= high + 1e-9 * unit; v += unit) found.push(Number(v.toPrecision(10)));
  return found;
}
const cursor = (over, value, from) => document.dispatchEvent(new CustomEvent("toothspace-cursor", { detail: { over, value, from } }));

// ---- a canvas that follows its width -------------------------------------------------------------
function sheet(box, height, draw) {
  const canvas = made("canvas"), state = { canvas, asked: 0 };
  canvas.style.cssText = `display:block;width:100%;height:${height}px;touch-action:pan-y`;
  box.append(canvas);
  state.again = () => { state.asked ||= requestAnimationFrame(() => {
    state.asked = 0;
    const w = canvas.clientWidth, h = canvas.clientHeight, r = devicePixelRatio || 1;
    if (!w) return;
    if (canvas.width !== Math.round(w * r) || canvas.height !== Math.round(h * r)) { canvas.width = Math.round(w * r); canvas.height = Math.round(h * r); }
    const g = canvas.getContext("2d"); g.setTransform(r, 0, 0, r, 0, 0); g.clearRect(0, 0, w, h); g.font = "11px system-ui, sans-serif";
    draw(g, w, h);
  }); };
  new ResizeObserver(state.again).observe(canvas);
  state.again();
  return state;
}
function frame(g, w, h, [x0, x1], [y0, y1], xLabel, yLabel) {
  const l = 56, r = 12, t = 8, b = 34, X = x => l + (x - x0) / (x1 - x0 || 1) * (w - l - r), Y = y => h - b - (y - y0) / (y1 - y0 || 1) * (h - t - b);
  g.strokeStyle = css("--line"); g.fillStyle = css("--soft"); g.lineWidth = .6;
  g.textAlign = "right"; g.textBaseline = "middle";
  for (const y of ticks(y0, y1, Math.max(2, h / 45))) { g.beginPath(); g.moveTo(l, Y(y)); g.lineTo(w - r, Y(y)); g.stroke(); g.fillText(text(y), l - 5, Y(y)); }
  g.textAlign = "center"; g.textBaseline = "top";
  for (const x of ticks(x0, x1, Math.max(2, w / 90))) { g.beginPath(); g.moveTo(X(x), t); g.lineTo(X(x), h - b); g.stroke(); g.fillText(text(x), X(x), h - b + 4); }
  if (xLabel) g.fillText(xLabel, (l + w - r) / 2, h - 14);
  if (yLabel) { g.save(); g.translate(9, (t + h - b) / 2); g.rotate(-Math.PI / 2); g.textBaseline = "middle"; g.fillText(yLabel, 0, 0); g.restore(); }
  return { X, Y, l, r, t, b, back: x => x0 + (x - l) / (w - l - r) * (x1 - x0), backY: y => y0 + (h - b - y) / (h - t - b) * (y1 - y0) };
}
const wide = ([low, high], share = .06) => { const room = Math.max(share * (high - low), 1e-9 + 1e-3 * Math.abs(high)); return [low - room, high + room]; };
const named = (label, unit) => unit && unit !== "1" ? `${label} (${unit})` : label;
const scaled = line => ({ ...line, values: line.values.map(v => v === null ? null : shown(v, line.unit)[0]), unit: shown(1, line.unit)[1] });
function nearest(list, value) { let best = 0; for (let k = 1; k < list.length; k++) if (Math.abs(list[k] - value) < Math.abs(list[best] - value)) best = k; return best; }
function pointer(canvas, moved) {
  const at = event => { const box = canvas.getBoundingClientRect(); moved(event.clientX - box.left, event.clientY - box.top, event); };
  canvas.addEventListener("pointermove", at); canvas.addEventListener("pointerdown", at);
}

// ---- kinds ---------------------------------------------------------------------------------------
const LINES = ["--one", "--two", "--three", "--soft"];
const KINDS = {
  curves(view, box, note) {
    const lines = view.lines.map(scaled), ys = wide(range(lines.flatMap(l => l.values))), xs = range(view.x);
    let at = null, axes = null;
    const drawn = sheet(box, 170, (g, w, h) => {
      axes = frame(g, w, h, xs, ys, view.over === "time" ? "Time (s)" : "Shaft angle (°)", lines[0].unit);
      lines.forEach((line, i) => { g.strokeStyle = css(LINES[i % 4]); g.lineWidth = 1.6; g.beginPath(); let on = false; line.values.forEach((v, k) => { if (v === null) { on = false; return; } on ? g.lineTo(axes.X(view.x[k]), axes.Y(v)) : g.moveTo(axes.X(view.x[k]), axes.Y(v)); on = true; }); g.stroke(); });
      if (at !== null) { g.strokeStyle = css("--ink"); g.lineWidth = 1; g.beginPath(); g.moveTo(axes.X(view.x[at]), axes.t); g.lineTo(axes.X(view.x[at]), h - axes.b); g.stroke(); }
    });
    pointer(drawn.canvas, x => axes && cursor(view.over, Math.min(Math.max(axes.back(x), xs[0]), xs[1]), box));
    return { again: drawn.again, cursor(over, value) { if (over !== view.over) return; at = nearest(view.x, value); note(`${text(view.x[at])}${view.unit}: ${lines.map(l => `${l.label} ${text(l.values[at])} ${l.unit}`).join(", ")}`); drawn.again(); } };
  },
  bars(view, box, note) {
    let chosen = 0;
    const bar = made("div", { className: "row" }), select = made("select", { ariaLabel: "Signal" }, ...view.lines.map((l, k) => new Option(l.label, k)));
    bar.append(select); box.append(bar);
    let axes = null, line = scaled(view.lines[0]);
    const drawn = sheet(box, 190, (g, w, h) => {
      const top = range(line.values)[1] || 1, far = Math.max(...line.x, 1);
      axes = frame(g, w, h, [0, far * 1.03], [0, top * 1.08], "Order (events per turn)", `Amplitude (${line.unit})`);
      g.fillStyle = css("--one"); const thick = Math.max(2, Math.min(8, (w - 70) / far * .6));
      line.x.forEach((x, k) => g.fillRect(axes.X(x) - thick / 2, axes.Y(line.values[k]), thick, h - axes.b - axes.Y(line.values[k])));
      g.fillStyle = css("--ink"); g.textAlign = "center"; g.textBaseline = "bottom";
      const strong = line.x.map((x, k) => k).sort((a, b) => line.values[b] - line.values[a]).slice(0, 4);
      for (const k of strong) g.fillText(text(line.x[k], 3), axes.X(line.x[k]), axes.Y(line.values[k]) - 1);
    });
    select.onchange = () => { chosen = Number(select.value); line = scaled(view.lines[chosen]); drawn.again(); };
    pointer(drawn.canvas, x => { if (!axes || !line.x.length) return; const k = nearest(line.x, axes.back(x)); note(`Order ${text(line.x[k])}: ${text(line.values[k])} ${line.unit}`); });
    return { again: drawn.again, cursor() {} };
  },
  path(view, box, note) {
    const x = scaled(view.x), y = scaled(view.y), circle = view.circle ? shown(view.circle, view.x.unit)[0] : null, same = x.unit === y.unit && circle;
    let at = 0, close = false, axes = null;
    if (circle) { const button = made("button", { type: "button", textContent: "Magnify the path", className: "small" }); button.setAttribute("aria-pressed", "false"); button.onclick = () => { close = !close; button.setAttribute("aria-pressed", close); button.textContent = close ? "Show the clearance" : "Magnify the path"; drawn.again(); }; box.append(made("div", { className: "row" }, button)); }
    const drawn = sheet(box, circle ? 300 : 240, (g, w, h) => {
      let xs = wide(range(x.values)), ys = wide(range(y.values));
      if (circle && !close) { xs = [-1.08 * circle, 1.08 * circle]; ys = [...xs]; }
      if (same) { // one scale for both axes
        const perX = (xs[1] - xs[0]) / (w - 68), perY = (ys[1] - ys[0]) / (h - 42), per = Math.max(perX, perY), grow = (s, size) => { const middle = (s[0] + s[1]) / 2; return [middle - size / 2, middle + size / 2]; };
        xs = grow(xs, per * (w - 68)); ys = grow(ys, per * (h - 42));
      }
      axes = frame(g, w, h, xs, ys, named(x.label, x.unit), named(y.label, y.unit));
      if (circle) { g.save(); g.beginPath(); g.rect(axes.l, axes.t, w - axes.l - axes.r, h - axes.t - axes.b); g.clip(); g.strokeStyle = css("--soft"); g.lineWidth = 1.4; g.beginPath(); g.arc(axes.X(0), axes.Y(0), Math.abs(axes.X(circle) - axes.X(0)), 0, 7); g.stroke(); g.restore(); }
      g.strokeStyle = css("--one"); g.lineWidth = 1.7; g.beginPath();
      x.values.forEach((v, k) => { if (v === null || y.values[k] === null) return; k ? g.lineTo(axes.X(v), axes.Y(y.values[k])) : g.moveTo(axes.X(v), axes.Y(y.values[k])); }); g.stroke();
      if (view.marks) { g.fillStyle = css("--one"); x.values.forEach((v, k) => { g.beginPath(); g.arc(axes.X(v), axes.Y(y.values[k]), 3, 0, 7); g.fill(); }); }
      if (view.marks || !circle) { // which way round
        const every = Math.max(1, Math.floor(x.values.length / 7)); g.fillStyle = css("--one");
        for (let k = every; k < x.values.length; k += every) { const dx = axes.X(x.values[k]) - axes.X(x.values[k - 1]), dy = axes.Y(y.values[k]) - axes.Y(y.values[k - 1]); if (Math.hypot(dx, dy) < .5) continue; const a = Math.atan2(dy, dx), px = axes.X(x.values[k]) - dx / 2, py = axes.Y(y.values[k]) - dy / 2; g.beginPath(); g.moveTo(px + 6 * Math.cos(a), py + 6 * Math.sin(a)); for (const s of [2.5, -2.5]) g.lineTo(px + 6 * Math.cos(a + s), py + 6 * Math.sin(a + s)); g.fill(); }
      }
      g.fillStyle = css("--two"); g.beginPath(); g.arc(axes.X(x.values[at]), axes.Y(y.values[at]), 5, 0, 7); g.fill();
    });
    pointer(drawn.canvas, (px, py) => { if (!axes) return; let best = 0, least = Infinity; x.values.forEach((v, k) => { const d = Math.hypot(axes.X(v) - px, axes.Y(y.values[k]) - py); if (d < least) { least = d; best = k; } }); if (least < 40) cursor(view.over, view.at[best], box); });
    return { again: drawn.again, cursor(over, value) { if (over !== view.over) return; at = nearest(view.at, value); note(`${x.label} ${text(x.values[at])} ${x.unit}, ${y.label} ${text(y.values[at])} ${y.unit}`); drawn.again(); } };
  },
  films(view, box, note) {
    let field = view.fields.length > 1 ? 1 : 0, space = false, turn = -.6, lean = 1, lift = 1, cells = null;
    const bar = made("div", { className: "row" }), select = made("select", { ariaLabel: "Field" }, ...view.fields.map((f, k) => new Option(named(f.label, shown(1, f.unit)[1]), k, false, k === field)));
    const flat = made("button", { type: "button", textContent: "In space", className: "small" }), more = made("input", { type: "range", min: .1, max: 3, step: .05, value: 1, ariaLabel: "Exaggeration" });
    flat.setAttribute("aria-pressed", "false"); more.hidden = true;
    bar.append(select, flat, more); box.append(bar);
    const solid = view.pieces[0].shape === "cylinder";
    const heights = range(view.pieces.flatMap(p => p.values[view.height]));
    const size = Math.max(...view.pieces.map(p => solid ? p.radius : Math.max(...p.v)));
    const edges = (list, wraps) => list.map((v, k) => k ? (v + list[k - 1]) / 2 : v - (list[1] - v) / 2).concat([list.at(-1) + (list.at(-1) - list.at(-2)) / 2]);
    function pieces(w, h) {
      const values = view.pieces.flatMap(p => p.values[field]), [low, high] = range(values), found = [];
      const log = field === view.height && low > 0 && high > 20 * low, share = v => log ? Math.log(v / low) / Math.log(high / low) : (v - low) / (high - low || 1);
      const scale = lift * .5 * size / (heights[1] - heights[0] || 1), tops = heights[0] + Math.min(heights[1] - heights[0], 1e9);
      for (const p of view.pieces) {
        const u = edges(p.u), v = edges(p.v), n = p.v.length, at = (i, j) => { const k = Math.min(Math.max(i, 0), p.u.length - 1) * n + Math.min(Math.max(j, 0), n - 1); return p.values[view.height][k]; };
        const middle = (v[0] + v.at(-1)) / 2;
        const place = (i, j) => { // corner of cells in space, height from the cells about it
          let sum = 0, count = 0;
          for (const [a, b] of [[i - 1, j - 1], [i - 1, j], [i, j - 1], [i, j]]) { if (b < 0 || b >= n) continue; const q = at((a + p.u.length) % p.u.length, b); if (q !== null) { sum += q; count++; } }
          const z = count ? (sum / count - heights[0]) * scale : 0;
          if (!solid) return [p.center[0] + v[j] * Math.cos(u[i]), p.center[1] + v[j] * Math.sin(u[i]), space ? z : 0];
          if (!space) return [u[i] * 180 / Math.PI, v[j], 0];
          const r = .6 * p.radius + z; return [r * Math.cos(u[i]), v[j] - middle, r * Math.sin(u[i])];
        };
        const corners = u.map((_, i) => v.map((_, j) => place(i, j)));
        for (let i = 0; i < p.u.length; i++) for (let j = 0; j < n; j++) {
          const value = p.values[field][i * n + j]; if (value === null || at(i, j) === null) continue;
          found.push({ p, i, j, value, share: share(value), quad: [corners[i][j], corners[i + 1][j], corners[i + 1][j + 1], corners[i][j + 1]] });
        }
      }
      return { found, low, high, log };
    }
    const drawn = sheet(box, 340, (g, w, h) => {
      const { found, low, high, log } = pieces(w, h), f = view.fields[field];
      const ca = Math.cos(turn), sa = Math.sin(turn), cb = Math.cos(lean), sb = Math.sin(lean);
      const project = space ? ([x, y, z]) => { const X = ca * x + sa * y, Y = -sa * x + ca * y; return [X, sb * 0 + cb * Y + sb * z, -sb * Y + cb * z]; } : ([x, y]) => [x, y, 0];
      let l = Infinity, r = -Infinity, b = Infinity, t = -Infinity;
      let X0 = 0, Y0 = 0;
      if (space && !solid) { const all = view.pieces.map(p => p.center); X0 = all.reduce((s, c) => s + c[0], 0) / all.length; Y0 = all.reduce((s, c) => s + c[1], 0) / all.length; }
      for (const q of found) { q.seen = q.quad.map(([x, y, z]) => project([x - X0, y - Y0, z])); q.depth = (q.seen[0][2] + q.seen[2][2]); for (const [x, y] of q.seen) { if (x < l) l = x; if (x > r) r = x; if (y < b) b = y; if (y > t) t = y; } }
      const room = 70, unrolled = solid && !space;
      if (unrolled) {
        const p = view.pieces[0], axes = frame(g, w - room, h, [l, r], [b, t], "Angle round the bearing (°)", "Along the axis (mm)");
        for (const q of found) { const [x, y] = [axes.X(q.quad[0][0]), axes.Y(q.quad[2][1])]; g.fillStyle = colour(q.share); g.fillRect(x, y, axes.X(q.quad[1][0]) - x + .6, axes.Y(q.quad[0][1]) - y + .6); q.at = [axes.X((q.quad[0][0] + q.quad[1][0]) / 2), axes.Y((q.quad[0][1] + q.quad[2][1]) / 2)]; }
      } else {
        const k = Math.min((w - room - 20) / (r - l || 1), (h - 20) / (t - b || 1)), ox = (w - room) / 2 - k * (l + r) / 2, oy = h / 2 + k * (b + t) / 2;
        if (space) found.sort((a, b) => a.depth - b.depth);
        for (const q of found) {
          const s = q.seen.map(([x, y]) => [ox + k * x, oy - k * y]);
          let light = 1;
          if (space) { const [a, b2, , d] = q.quad, e1 = a.map((v, i) => b2[i] - v), e2 = a.map((v, i) => d[i] - v), n = [e1[1] * e2[2] - e1[2] * e2[1], e1[2] * e2[0] - e1[0] * e2[2], e1[0] * e2[1] - e1[1] * e2[0]]; light = .62 + .38 * Math.abs((.3 * n[0] + .4 * n[1] + .86 * n[2]) / (Math.hypot(...n) || 1)); }
          g.fillStyle = g.strokeStyle = colour(q.share, light); g.lineWidth = .7;
          g.beginPath(); s.forEach(([x, y], i) => i ? g.lineTo(x, y) : g.moveTo(x, y)); g.closePath(); g.fill(); g.stroke();
          q.at = [(s[0][0] + s[2][0]) / 2, (s[0][1] + s[2][1]) / 2];
        }
      }
      cells = found;
      const steps = 40, tall = h - 70, x0 = w - 60;
      for (let i = 0; i < steps; i++) { g.fillStyle = colour((i + .5) / steps); g.fillRect(x0, 35 + tall * (1 - (i + 1) / steps), 14, tall / steps + .6); }
      g.fillStyle = css("--ink"); g.textAlign = "left"; g.textBaseline = "middle";
      for (const [s, v] of [[1, high], [.5, log ? Math.sqrt(low * high) : (low + high) / 2], [0, low]]) g.fillText(text(shown(v, f.unit)[0], 3), x0 + 18, 35 + tall * (1 - s));
      g.textAlign = "right"; g.fillText(shown(1, f.unit)[1] === "1" ? "" : shown(1, f.unit)[1], w - 6, 20);
    });
    let held = null;
    select.onchange = () => { field = Number(select.value); drawn.again(); };
    flat.onclick = () => { space = !space; flat.textContent = space ? "In the plane" : "In space"; flat.setAttribute("aria-pressed", space); more.hidden = !space; drawn.canvas.style.touchAction = space ? "none" : "pan-y"; drawn.again(); };
    more.oninput = () => { lift = Number(more.value); drawn.again(); };
    drawn.canvas.addEventListener("pointerdown", event => { if (space) { held = [event.clientX, event.clientY]; drawn.canvas.setPointerCapture(event.pointerId); } });
    drawn.canvas.addEventListener("pointerup", () => { held = null; });
    pointer(drawn.canvas, (x, y, event) => {
      if (held) { turn -= (event.clientX - held[0]) * .01; lean = Math.min(Math.max(lean - (event.clientY - held[1]) * .01, 0), 1.5); held = [event.clientX, event.clientY]; drawn.again(); return; }
      let best = null, least = 400;
      for (const q of cells ?? []) { const d = (q.at[0] - x) ** 2 + (q.at[1] - y) ** 2; if (d < least) { least = d; best = q; } }
      if (best) { const k = best.i * best.p.v.length + best.j; note(`${best.p.label}: ${view.fields.map((f, i) => `${f.label} ${told(best.p.values[i][k], f.unit)}`).join(", ")}`); }
    });
    return { again: drawn.again, cursor() {} };
  },
  tree(view, box, note) {
    const total = view.tree.value; let areas = [];
    const drawn = sheet(box, Math.max(200, 22 * view.tree.children.reduce((s, c) => s + c.children.length, 0)), (g, w, h) => {
      areas = []; const columns = [0, .16, .46].map(x => x * w), ends = [.155, .455, 1].map(x => x * w);
      const put = (node, level, top, bottom, shade, parent) => {
        const [x, y, width, height] = [columns[level], top, ends[level] - columns[level], Math.max(bottom - top - 1.5, .5)];
        g.fillStyle = css(shade); g.globalAlpha = level === 2 ? .35 : level === 1 ? .6 : .25; g.fillRect(x, y, width, height); g.globalAlpha = 1;
        areas.push({ x, y, width, height, node, parent });
        if (height > 11) { g.fillStyle = css("--ink"); g.textAlign = "left"; g.textBaseline = "middle"; g.save(); g.beginPath(); g.rect(x, y, width, height); g.clip(); g.fillText(`${node.label}${level ? ":" : ""} ${level ? told(node.value, view.unit, 3) : ""}`, x + 5, y + height / 2); if (!level) g.fillText(told(node.value, view.unit, 3), x + 5, y + height / 2 + 14); g.restore(); }
        let at = top;
        (node.children ?? []).forEach((child, k) => { const end = at + (bottom - top) * child.value / node.value; put(child, level + 1, at, end, level ? shade : LINES[k % 4], node); at = end; });
      };
      put(view.tree, 0, 0, h, "--soft", null);
    });
    pointer(drawn.canvas, (x, y) => { const hit = areas.findLast(a => x >= a.x && x <= a.x + a.width && y >= a.y && y <= a.y + a.height); if (hit) note(`${hit.parent && hit.parent !== view.tree ? `${hit.parent.label}, ` : ""}${hit.node.label}: ${told(hit.node.value, view.unit)}, ${text(100 * hit.node.value / total, 3)} % of what is lost`); });
    return { again: drawn.again, cursor() {} };
  },
  map(view, box, note, options) {
    let field = 0, chosen = null, axes = null;
    const bar = made("div", { className: "row" }), select = made("select", { ariaLabel: "Number" }, ...view.fields.map((f, k) => new Option(named(f.label, shown(1, f.unit)[1]), k)));
    const open = made("button", { type: "button", textContent: "Open this point", className: "small", disabled: true }); open.hidden = !options.open || !view.points.length;
    bar.append(select, open); box.append(bar);
    const x = scaled(view.x), y = scaled(view.y), n = y.values.length;
    const bounds = list => list.map((v, k) => k ? (v + list[k - 1]) / 2 : v - (list[1] - v) / 2).concat([list.at(-1) + (list.at(-1) - list.at(-2)) / 2]);
    const xs = x.values.length > 1 ? bounds(x.values) : [x.values[0] - 1, x.values[0] + 1], ys = n > 1 ? bounds(y.values) : [y.values[0] - 1, y.values[0] + 1];
    const drawn = sheet(box, 300, (g, w, h) => {
      const f = scaled(view.fields[field]), [low, high] = range(f.values);
      axes = frame(g, w, h, [xs[0], xs.at(-1)], [ys[0], ys.at(-1)], named(x.label, x.unit), named(y.label, y.unit));
      x.values.forEach((_, i) => y.values.forEach((_, j) => {
        const v = f.values[i * n + j]; if (v === null) return;
        const share = (v - low) / (high - low || 1), [l, r, t, b] = [axes.X(xs[i]), axes.X(xs[i + 1]), axes.Y(ys[j + 1]), axes.Y(ys[j])];
        g.fillStyle = colour(share); g.fillRect(l, t, r - l, b - t);
        if (r - l > 34 && b - t > 13) { g.fillStyle = share > .55 ? "#111" : "#fff"; g.textAlign = "center"; g.textBaseline = "middle"; g.fillText(text(v, 3), (l + r) / 2, (t + b) / 2); }
        if (chosen === i * n + j) { g.strokeStyle = css("--two"); g.lineWidth = 3; g.strokeRect(l + 1.5, t + 1.5, r - l - 3, b - t - 3); }
      }));
    });
    const hit = (px, py) => { if (!axes) return null; const a = axes.back(px), b = axes.backY(py), i = xs.findIndex((v, k) => a >= v && a < xs[k + 1]), j = ys.findIndex((v, k) => b >= v && b < ys[k + 1]); return i < 0 || j < 0 ? null : i * n + j; };
    const tell = k => note(`${text(x.values[Math.floor(k / n)])} ${x.unit}, ${text(y.values[k % n])} ${y.unit}: ${view.fields.map(f => `${f.label} ${told(f.values[k], f.unit)}`).join(", ")}`);
    select.onchange = () => { field = Number(select.value); drawn.again(); };
    pointer(drawn.canvas, (px, py, event) => { const k = hit(px, py); if (k === null) return; if (event.type === "pointerdown") { chosen = k; open.disabled = false; drawn.again(); } tell(chosen ?? k); });
    open.onclick = () => chosen !== null && options.open(view.points[chosen]);
    // a mouse has seen the numbers before it clicks; a finger chooses first, then opens
    let last = null;
    if (!open.hidden) { drawn.canvas.style.cursor = "pointer"; drawn.canvas.addEventListener("click", event => { const k = hit(event.offsetX, event.offsetY), twice = k === last; last = k; if (k !== null && (event.pointerType !== "touch" || twice)) options.open(view.points[k]); }); }
    return { again: drawn.again, cursor() {} };
  },
};

window.toothspaceViews = function (box, views, options = {}) {
  if (options.shown) shown = options.shown;
  if (options.text) text = options.text;
  box.replaceChildren(); box.classList.add("views");
  const parts = views.map(view => {
    const own = made("figure", { className: "view" }), body = made("div"), line = made("output", { className: "small" });
    own.dataset.view = view.name;
    own.append(made("h4", { textContent: view.title }), body, line, view.caption ? made("figcaption", { textContent: view.caption }) : "");
    box.append(own);
    return KINDS[view.kind](view, body, message => { line.textContent = message; }, options);
  });
  box.onCursor && document.removeEventListener("toothspace-cursor", box.onCursor);
  box.onCursor = ({ detail }) => { for (const part of parts) part.cursor(detail.over, detail.value); };
  document.addEventListener("toothspace-cursor", box.onCursor);
  return { again: () => parts.forEach(part => part.again()) };
};
})();
