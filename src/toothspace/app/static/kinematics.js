// Numbers and outlines of a machine in closed form, which follow a handle within a frame. The formulas are those of
// geometry/involute_gear.py, geometry/gear_pair.py, gearing/ring_gear.py and machines/gerotor; a test holds both together.
// Lengths in mm, angles in rad; keys of the case in their own units.
const { PI, tan, sin, cos, acos, asin, atan, atan2, asinh, sqrt, hypot, min, max, abs } = Math, DEG = PI / 180;
const inv = a => tan(a) - a, clip = (x, low, high) => min(max(x, low), high);
function between(f, low, high) {
  for (let k = 0; k < 60; k++) { const middle = .5 * (low + high); if (f(low) * f(middle) <= 0) high = middle; else low = middle; }
  return .5 * (low + high);
}

// teeth that a rack with rounded tip cuts; lengths of the transverse section
function tooth(of) {
  const slope = cos((of("helix_angle") ?? 0) * DEG), z = of("tooth_count"), m = of("module") / slope, alpha = atan(tan(of("pressure_angle") * DEG) / slope);
  const x = (of("profile_shift") ?? 0) * slope, h = (of("dedendum") ?? 1.25) * slope, tip = .5 * of("tip_diameter"), rounding = of("tip_rounding") ?? 0, given = of("tool_tip_radius");
  const s = sin(alpha), c = cos(alpha), r = .5 * m * z, base = r * c, root = r - (h - x) * m, half = 2 * (.25 * PI + x * tan(alpha)) / z + inv(alpha);
  const wide = .25 * PI - h * tan(alpha), most = wide * c / (1 - s), radius = given === undefined ? min(.38, most) : given * slope;
  const side = max(wide - radius * (1 - s) / c, 0) * m, depth = (h - x - radius) * m, rho = radius * m;
  const roll = q => sqrt(max(q * q - base * base, 0)), halfAngle = q => half - inv(acos(min(base / q, 1)));
  const fillet = t => { const d = depth + rho / sqrt(1 + t * t); return [hypot(r - d, d * t), atan2(d * t, r - d) - (depth * t - side) / r]; };
  let last = c / s, form = hypot(base, r * s - (depth + rho * s) / s);
  const undercut = r * s * s < depth + rho * s;
  if (undercut) {
    const gap = t => { const [q, space] = fillet(t); return space + halfAngle(max(q, base)) - PI / z; };
    const start = fillet(0)[0] < base && fillet(last)[0] > base ? between(t => fillet(t)[0] / base - 1, 0, last) : 0;
    last = gap(start) > 0 && gap(last) < 0 ? between(gap, start, last) : start; form = fillet(last)[0];
  }
  const center = tip - rounding, tipForm = hypot(base, roll(center) + rounding), tipHalf = halfAngle(center) - rounding / base;
  return { z, m, alpha, x, h, r, base, root, half, tip, rounding, side, depth, rho, roll, halfAngle, fillet, last, form, undercut, center, tipForm, tipHalf, land: 2 * tipHalf * tip, pitch: PI * m * c };
}
// section of a gear over its tooth count
function toothArea(g) {
  let half = .5 * g.tip ** 2 * g.tipHalf + (g.roll(g.tipForm) ** 3 - g.roll(g.form) ** 3) / (6 * g.base) + .5 * g.root ** 2 * g.side / g.r;
  if (g.rounding > 0) {
    const at = g.halfAngle(g.tipForm), [cx, cy] = [g.center * cos(g.tipHalf), g.center * sin(g.tipHalf)], [ex, ey] = [g.tipForm * cos(at), g.tipForm * sin(at)];
    const turn = atan2(ey - cy, ex - cx) - g.tipHalf, [dx, dy] = [ex - g.tip * cos(g.tipHalf), ey - g.tip * sin(g.tipHalf)];
    half += .5 * (g.rounding ** 2 * turn + cx * dy - cy * dx);
  }
  const { depth: d, rho, last: t, r } = g, s = asinh(t), root = sqrt(1 + t * t), first = d * t + rho * s, square = d * d * t + 2 * d * rho * s + rho * rho * atan(t);
  const turning = r * r * t - 2 * r * first + square + d * d * t ** 3 / 3 + d * rho * (t * root - s) + rho * rho * (t - atan(t));
  return 2 * (half + .5 * (r * first - square - r * rho * (s - t / root) - d / r * turning));
}
// angle whose involute function is given, by Newton from above
function angleOf(target) {
  if (!(target > 0)) return NaN;
  let a = min(Math.cbrt(3 * target), 1.4);
  for (let k = 0; k < 60; k++) { const t = tan(a), step = (t - a - target) / (t * t); a -= step; if (!(step > 1e-15)) break; }
  return a;
}
function sealing([start, end], span) { const room = .5 * max(end - start - span, 0), middle = .5 * (start + end - span), first = clip(-.5 * span, middle - room, middle + room); return [first, first + span]; }
// displacement per turn and its ripple, of an external (ratio below 0) or internal pair
function delivery(tips, rolling, ratio, path, pitch, width) {
  const [a, b] = sealing(path, pitch), swept = tips[0] ** 2 - rolling[0] ** 2 - ratio * (tips[1] ** 2 - rolling[1] ** 2);
  const mean = .5 * width * (swept - (1 - ratio) * (a * a + a * b + b * b) / 3), most = max(abs(a), abs(b)), least = max(a, -b, 0);
  return { displacement_cm3_per_rev: 2e-3 * PI * mean, flow_ripple_percent: 50 * (1 - ratio) * (most ** 2 - least ** 2) * width / mean };
}

function externalGear(values, { mode, limits }) {
  const own = name => values[`machine.gears.${name}`], drive = tooth(own);
  const other = ["tooth_count", "profile_shift", "dedendum", "tool_tip_radius", "tip_diameter", "tip_rounding"].some(name => values[`machine.driven_gear.${name}`] !== undefined);
  const driven = other ? tooth(name => values[`machine.driven_gear.${name}`] ?? own(name)) : drive;
  const total = drive.base + driven.base, width = own("face_width"), helix = (own("helix_angle") ?? 0) * DEG, slope = cos(atan(tan(helix) * cos(drive.alpha)));
  const tight = (drive.z * drive.half + driven.z * driven.half - PI) / (drive.z + driven.z);
  const distance = own("center_distance") ?? total / cos(angleOf(tight + .5 * own("normal_backlash") / slope / total)), angle = acos(total / distance);
  const backlash = 2 * total * (inv(angle) - tight) * slope, share = drive.z / (drive.z + driven.z), rolling = [distance * share, distance * (1 - share)], rolls = rolling.map(q => q * sin(angle));
  const path = [max(rolls[1] - driven.roll(driven.tipForm), drive.undercut ? drive.roll(drive.form) - rolls[0] : -Infinity), min(drive.roll(drive.tipForm) - rolls[0], driven.undercut ? rolls[1] - driven.roll(driven.form) : Infinity)];
  const pitch = drive.pitch, ratio = (path[1] - path[0]) / pitch, clearances = [distance - drive.root - driven.tip, distance - driven.root - drive.tip];
  const areas = [drive, driven].map(toothArea), volume = u => { const p = rolls[0] + u, q = rolls[1] - u; return width * (.5 * pitch * total - areas[0] - areas[1] + ((p + pitch) ** 3 - p ** 3) / (6 * drive.base) + (q ** 3 - (q - pitch) ** 3) / (6 * driven.base)); };
  const ends = [path[0], path[1] - pitch], first = mode === "motor" ? ends[1] : ends[0], trapped = volume(first), dead = volume(clip(-.5 * pitch, min(...ends), max(...ends)));
  const found = { ...delivery([drive.tip, driven.tip], rolling, -drive.z / driven.z, path, pitch, width), contact_ratio: ratio, trapped_volume_mm3: trapped, dead_volume_mm3: dead, tip_land_mm: min(drive.land, driven.land), root_clearance_mm: min(...clearances), center_distance_mm: distance, normal_backlash_mm: backlash, operating_pressure_angle_deg: angle / DEG, base_diameter_mm: 2 * drive.base, face_width_mm: width };
  if (helix) for (const name of ["flow_ripple_percent", "trapped_volume_mm3", "dead_volume_mm3"]) delete found[name];
  const margins = [rolls[0] + rolls[1] - driven.roll(driven.tipForm) - drive.roll(drive.form), rolls[0] + rolls[1] - drive.roll(drive.tipForm) - driven.roll(driven.form)];
  const least = (.06 + .0005 * distance + .03 * drive.m) * 2 / 3, verdicts = { "Contact ratio": [ratio, ratio >= limits.contact_ratio[0] && ratio <= limits.contact_ratio[1]], "Normal backlash": [backlash, backlash >= least && backlash <= limits.backlash * drive.m] };
  [["drive gear", drive], ["driven gear", driven]].forEach(([name, g], k) => {
    verdicts[`Tip land, ${name}`] = [g.land, g.land >= limits.tip_land * g.m];
    verdicts[`Root clearance, ${name}`] = [clearances[k], clearances[k] >= limits.root_clearance * g.m];
    verdicts[`Fillet interference, ${name}`] = [margins[k], margins[k] >= 0 || g.undercut];
  });
  return { numbers: found, rules: verdicts, teeth: [drive, driven], centers: [null, [0, distance]] };
}

function crescent(values, { limits }) {
  const own = name => values[`machine.pinion.${name}`], ring = name => values[`machine.ring.${name}`], pinion = tooth(own);
  const space = tooth(name => ({ tooth_count: ring("tooth_count"), profile_shift: ring("profile_shift") ?? 0, tip_diameter: ring("root_diameter"), tip_rounding: ring("root_fillet") ?? 0, dedendum: 1.25 / cos((own("helix_angle") ?? 0) * DEG), tool_tip_radius: undefined })[name] ?? (["dedendum", "tool_tip_radius"].includes(name) ? undefined : own(name)));
  const difference = space.base - pinion.base, slope = cos(atan(tan((own("helix_angle") ?? 0) * DEG) * cos(pinion.alpha))), ringTip = .5 * ring("tip_diameter"), width = own("face_width");
  const tight = inv(pinion.alpha) + 2 * tan(pinion.alpha) * (space.x - pinion.x) / (space.z - pinion.z);
  const distance = own("center_distance") ?? difference / cos(angleOf(tight - .5 * own("normal_backlash") / slope / difference)), angle = acos(difference / distance);
  const ratio = pinion.z / space.z, rolling = [distance * ratio / (1 - ratio)]; rolling.push(rolling[0] + distance);
  const offset = distance * sin(angle), pitchPoint = rolling[0] * sin(angle), path = [max(space.roll(ringTip) - offset, pinion.roll(pinion.form)) - pitchPoint, min(pinion.roll(pinion.tipForm), space.roll(space.tipForm) - offset) - pitchPoint];
  const clearances = [ringTip - distance - pinion.root, space.tip - distance - pinion.tip], contact = (path[1] - path[0]) / pinion.pitch;
  const found = { ...delivery([pinion.tip, ringTip], rolling, ratio, path, pinion.pitch, width), contact_ratio: contact, root_clearance_mm: min(...clearances), center_distance_mm: distance, operating_pressure_angle_deg: angle / DEG, face_width_mm: width };
  if (own("helix_angle")) delete found.flow_ripple_percent;
  return { numbers: found, rules: {}, teeth: [pinion], centers: [null, [0, -distance]] };
}

// lobes of the outer rotor touch the inner one where the line from their centre to the pitch point leaves them
function trochoidalGerotor(values) {
  const of = name => values[`machine.rotors.${name}`], n = of("inner_tooth_count"), lobes = n + 1, e = of("eccentricity"), R = of("generating_radius"), q = of("lobe_radius"), width = of("face_width"), ratio = n / lobes;
  const swept = place => { const x = R * sin(place), y = -R * cos(place), dx = -x, dy = -lobes * e - y, l = hypot(dx, dy), px = x + q * dx / l, py = y + q * dy / l; return .5 * (px * px + (py + e) ** 2 - ratio * (px * px + py * py)); };
  const steps = 40, count = steps * lobes, step = 2 * PI / count, s = Array.from({ length: count }, (_, k) => swept(k * step)), half = steps / 2;
  const rate = s.map((_, k) => s[(k + half) % count] - s[(k - half + count) % count]), area = .5 * rate.reduce((sum, v) => sum + abs(v), 0) * step / ratio;
  const flow = Array.from({ length: steps }, (_, k) => { let sum = 0; for (let j = k; j < count; j += steps) sum += max(rate[j], 0); return sum; });
  let curvature = 0;
  for (let k = 0; k < 400; k++) { const t = 2 * PI * k / 400, c = R * R + (lobes * e) ** 2 - 2 * R * lobes * e * cos(t); curvature = max(curvature, (R * R + lobes ** 3 * e * e - R * e * lobes * (lobes + 1) * cos(t)) / c ** 1.5); }
  const limit = 1 / curvature, closure = R * sin(PI / lobes), gap = .5 * of("tip_clearance") * 1e-3;
  const numbers = { displacement_cm3_per_rev: n * area * width * 1e-3, flow_ripple_percent: 100 * (max(...flow) - min(...flow)) / (flow.reduce((a, b) => a + b) / steps), no_undercut_limit_mm: limit, eccentricity_mm: e, face_width_mm: width, inner_tip_diameter_mm: 2 * (R - q + e - gap), outer_root_diameter_mm: 2 * (R - q + 2 * e + gap) };
  return { numbers, rules: { "Lobe radius over its no-undercut limit": [q / limit, q < .95 * limit], "Lobe radius over half the lobe distance": [q / closure, q < .95 * closure], "Flow ripple": [numbers.flow_ripple_percent, numbers.flow_ripple_percent < 10] }, trochoid: { n, lobes, e, R, q, gap }, centers: [[0, -e]] };
}

// outline of a gear, a tooth on the x axis
export function gearOutline(g) {
  const half = [], add = (q, a) => half.push([q * cos(a), q * sin(a)]);
  add(g.tip, 0); add(g.tip, max(g.tipHalf, 0));
  const [from, to] = [g.roll(g.tipForm), g.roll(g.form)];
  for (let k = 0; k <= 8; k++) { const q = hypot(g.base, from + (to - from) * k / 8); add(q, g.halfAngle(q)); }
  const angle = atan(g.last);
  for (let k = 1; k <= 6; k++) { const [q, space] = g.fillet(tan(angle * (1 - k / 6))); add(q, PI / g.z - space); }
  const tooth = [...half.slice(1).reverse().map(([x, y]) => [x, -y]), ...half];
  return turned(tooth, g.z, 0);
}
function turned(points, count, start) {
  return Array.from({ length: count }, (_, k) => start + 2 * PI * k / count).flatMap(t => points.map(([x, y]) => [x * cos(t) - y * sin(t), x * sin(t) + y * cos(t)]));
}
// inner rotor and inside of the outer one, each about its own centre
export function rotorOutlines({ n, lobes, e, R, q, gap }) {
  const inner = [], start = -.5 * PI + PI / lobes, points = 24 * n, first = (.5 * PI - start) / n; // tips and roots are among the points
  for (let k = 0; k < points; k++) {
    const s = first - 2 * PI * k / points, a = start - s, b = -lobes * s, cx = R * cos(a) - e * sin(b), cy = R * sin(a) + e * cos(b);
    // along the path of the lobe's centre; the profile lies on its inner side
    const dx = R * sin(a) + lobes * e * cos(b), dy = -R * cos(a) + lobes * e * sin(b), l = hypot(dx, dy), r = q + gap;
    inner.push([cx + r * dy / l, cy - r * dx / l]);
  }
  const r = q - gap, floor = R - q + 2 * e + gap, half = PI / lobes, corner = min(acos((R * R + floor * floor - r * r) / (2 * R * floor)), half), swing = acos((R * R + r * r - floor * floor) / (2 * R * r)), one = [];
  for (let k = -6; k <= 6; k++) { const t = swing * k / 6; one.push([R - r * cos(t), r * sin(t)]); }
  for (let k = 1; k < 6; k++) { const t = corner + (2 * half - 2 * corner) * k / 6; one.push([floor * cos(t), floor * sin(t)]); }
  return [inner, turned(one, lobes, start)];
}

const FORMS = { external_gear: externalGear, crescent, trochoidal: trochoidalGerotor };
// values: keys of the case by path, in their units; null where the machine has no closed form
export function kinematics(closed, values) {
  const form = FORMS[closed?.kind];
  if (!form) return null;
  const found = form({ ...closed.values, ...values }, closed);
  return Object.values(found.numbers).every(Number.isFinite) ? found : null;
}
