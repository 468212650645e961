// Curves over the shaft angle with the last state as a ghost behind them, one cursor through all.
import { element } from "./dom.js";
import { factor, text, toShown, unitShown } from "./units.js";

const css = name => getComputedStyle(document.documentElement).getPropertyValue(name).trim();
const COLOURS = ["--one", "--two", "--three"];
export class Curves {
  constructor(box, onAngle) { Object.assign(this, { box, onAngle, plots: new Map(), quiet: false }); }
  show(groups) {
    for (const [name, plot] of this.plots) if (!groups.some(g => g.name === name)) { plot.destroy(); plot.holder.remove(); this.plots.delete(name); }
    for (const group of groups) this.one(group);
  }
  one({ name, title, unit, x, lines, ghosts = [], measured = null, height = 170, xUnit = "°" }) {
    const series = [], data = [x];
    ghosts.forEach((values, k) => { if (values && values.length === x.length) { series.push({ label: `before`, stroke: css("--ghost"), width: 1.4, dash: [5, 4] }); data.push(values.map(v => v === null ? null : toShown(v, unit))); } });
    lines.forEach((line, k) => { series.push({ label: line.label, stroke: line.colour ?? css(COLOURS[k % COLOURS.length]), width: 1.8 }); data.push(line.values.map(v => v === null ? null : toShown(v, unit))); });
    if (measured) { series.push({ label: "measured", stroke: css("--ink"), width: 1, points: { show: true, size: 3 } }); data.push(measured); }
    const shape = JSON.stringify([series.map(s => [s.label, s.stroke]), unitShown(unit), height]);
    let plot = this.plots.get(name);
    if (plot && plot.shape === shape) { plot.setData(data); return; }
    const holder = plot?.holder ?? element("div", { className: "curve" });
    plot?.destroy();
    holder.replaceChildren(element("h4", { textContent: `${title}${unit ? `, ${unitShown(unit)}` : ""}` }));
    if (!holder.parentElement) this.box.append(holder);
    const axis = { stroke: css("--soft"), grid: { stroke: css("--line"), width: .5 }, ticks: { show: false }, font: "11px system-ui" };
    plot = new uPlot({
      width: Math.max(holder.clientWidth - 8, 200), height,
      series: [{ label: "shaft angle", value: (_, v) => v === null ? "–" : `${text(v, 4)}${xUnit}` }, ...series.map(s => ({ ...s, value: (_, v) => v === null ? "–" : text(v, 4) }))],
      axes: [{ ...axis, size: 26 }, { ...axis, size: 54, values: (_, ticks) => ticks.map(v => text(v, 5)) }],
      scales: { x: { time: false }, y: { range: (_, low, high) => { const room = .06 * Math.max(high - low, 1e-9 + .002 * Math.abs(high)); return [low - room, high + room]; } } },
      cursor: { sync: { key: this.box.id }, drag: { x: true, y: false } },
      hooks: { setCursor: [u => { if (!this.quiet && u.cursor.event && u.cursor.idx !== null) this.onAngle?.(u.data[0][u.cursor.idx]); }] },
    }, data, holder);
    Object.assign(plot, { shape, holder }); this.plots.set(name, plot);
    if (!holder.watched) { holder.watched = true; new ResizeObserver(() => { const w = holder.clientWidth - 8, own = this.plots.get(name); if (w > 150 && own && Math.abs(own.width - w) > 2) own.setSize({ width: w, height }); }).observe(holder); }
  }
  cursor(angle) {
    this.quiet = true;
    for (const plot of this.plots.values()) plot.setCursor({ left: plot.valToPos(angle, "x"), top: 20 }, false);
    this.quiet = false;
  }
}
export { factor };
