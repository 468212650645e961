// What a relief groove opens of a tooth space while its edges move: the outlines of the space, known at angles of its turn, cut
// with the groove. The formula is that of gearing/openings.py; a test holds both together. Lengths in mm.
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
