// What a relief groove opens of a tooth space, and a kidney of a pocket, while its edges move: outlines of the space, known at
// angles of its turn, cut with the opening. The formulas are those of gearing/openings.py and machines/gerotor/ports.py; a test
// holds both together. Lengths in mm.
function clipped(points, [ax, ay], [bx, by]) {
  const out = [], side = ([x, y]) => (bx - ax) * (y - ay) - (by - ay) * (x - ax);
  for (let k = 0; k < points.length; k++) {
    const p = points[k], q = points[(k + 1) % points.length], d = side(p), e = side(q);
    if (d >= 0) out.push(p);
    if (d * e < 0) { const f = d / (d - e); out.push([p[0] + f * (q[0] - p[0]), p[1] + f * (q[1] - p[1])]); }
  }
  return out;
}
const twiceArea = points => points.reduce((sum, [x, y], k) => { const [u, v] = points[(k + 1) % points.length]; return sum + x * v - y * u; }, 0);
function overlap(space, groove, depth) {
  let points = space;
  for (let k = 0; k < groove.length && points.length; k++) points = clipped(points, groove[k], groove[(k + 1) % groove.length]);
  const area = .5 * Math.abs(twiceArea(points)), y = points.map(p => p[1]);
  if (!(area > 1e-6)) return 0;
  // along the axis through the overlap, then sideways through the depth of the groove
  const passage = depth * (Math.max(...y) - Math.min(...y));
  return area * passage / Math.hypot(area, passage);
}
// one curve for each groove and kind of space, at the angles of the diagram
export function grooveOpenings({ grooves, spaces }, recesses, depth) {
  return grooves.map(({ family, role, recess, faces, nodes }) => {
    const values = new Array(nodes + 1).fill(0), corners = recesses[recess].slice(0, -1), groove = twiceArea(corners) < 0 ? corners.reverse() : corners;
    for (const [place, space] of Object.entries(spaces[family])) values[place] = faces * overlap(space, groove, depth);
    values[nodes] = values[0];
    return { family, role, values };
  });
}
// signed area that a closed line has in common with the disk about the origin, edge by edge from there
function inDisk(points, r) {
  const cross = ([a, b], [c, d]) => a * d - b * c, sector = (u, v) => .5 * r * r * Math.atan2(cross(u, v), u[0] * v[0] + u[1] * v[1]);
  return points.reduce((sum, p, k) => {
    const q = points[(k + 1) % points.length], d = [q[0] - p[0], q[1] - p[1]], a = d[0] * d[0] + d[1] * d[1];
    if (!a) return sum;
    const b = p[0] * d[0] + p[1] * d[1], c = p[0] * p[0] + p[1] * p[1] - r * r, root = Math.sqrt(Math.max(b * b - a * c, 0)), [from, to] = [(-b - root) / a, (-b + root) / a];
    if (!root || to <= 0 || from >= 1) return sum + sector(p, q);
    const at = t => [p[0] + t * d[0], p[1] + t * d[1]], u = from > 0 ? at(from) : p, v = to < 1 ? at(to) : q;
    return sum + (from > 0 ? sector(p, u) : 0) + .5 * cross(u, v) + (to < 1 ? sector(v, q) : 0);
  }, 0);
}
// both kidneys are mirrored on the line of centres; half lands in degrees
export function kidneyOpenings({ family, nodes, spaces, kidneys }, moved) {
  const { land_max_half_angle: last, land_min_half_angle: first, inner_radius: inner, outer_radius: outer } = { ...kidneys, ...moved }, edge = degrees => [Math.cos(degrees * Math.PI / 180), Math.sin(degrees * Math.PI / 180)];
  const begin = edge(first - 90), end = edge(90 - last), opened = points => {
    const between = clipped(clipped(points, [0, 0], begin), end, [0, 0]), area = Math.abs(inDisk(between, outer) - inDisk(between, inner));
    return area > 1e-6 ? area : 0;
  };
  return [["inlet_port", 1], ["outlet_port", -1]].map(([role, side]) => {
    const values = new Array(nodes + 1).fill(0);
    for (const [place, space] of Object.entries(spaces)) values[place] = opened(space.map(([x, y]) => [side * x, y]));
    values[nodes] = values[0];
    return { family, role, values };
  });
}
