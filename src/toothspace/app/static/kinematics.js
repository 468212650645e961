// Numbers and outlines of a machine in closed form, which follow a handle within a frame. The formulas are those of
// geometry/involute_gear.py, geometry/gear_pair.py, geometry/continuous_contact.py, gearing/ring_gear.py, machines/gerotor and
// advice/gear_rules.py; a test holds both together.
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

// clearances of bearings over their radius, by the body that they carry, and the play of both gears over the room in the teeth
function bearings(of, limits, room) {
  const found = {}, [least, most] = limits.bearing;
  for (const [name, clearance, diameter] of of) { const v = 2e-3 * clearance / diameter; found[`Relative clearance of the bearing, ${name}`] = [v, v >= least && v <= most]; }
  if (room !== undefined) { const play = of.reduce((sum, [, clearance]) => sum + 1e-3 * clearance, 0); found["Bearing play of both gears"] = [play, play < room]; }
  return found;
}
// rules of the housing and the bearings of external gears; clearances in um
function around(values, limits, room) {
  const of = name => values[`machine.${name}`], own = of("journal_bearings.radial_clearance"), diameter = of("journal_bearings.diameter");
  const cut = max(own + (of("bearing_blocks.radial_clearance") ?? 0) - of("casing.radial_clearance"), 0);
  return { "Cut into the casing": [cut, cut <= limits.cut], ...bearings([["drive gear", own, diameter], ["driven gear", own, diameter]], limits, room) };
}
// loads of bearings, flanks and roots at the condition of running-in; MPa, mm, N
function strength(values, limits, { width, volume, ratio, rolling, gears }) {
  const of = name => values[`machine.${name}`], pressure = .1 * of("casing.wear_in.pressure") - limits.atmosphere, omega = of("casing.wear_in.shaft_speed") * PI / 30;
  const diameter = of("journal_bearings.diameter"), load = limits.radial_load * pressure * width * 2 * max(...gears.map(g => g.tip)) / (2 * diameter * of("journal_bearings.length"));
  const lever = gears[1].base, force = .5 * pressure * volume / (ratio * lever), sine = sqrt(max(1 - (lever / rolling[1]) ** 2, 1e-4)), radius = sine / (1 / rolling[0] + 1 / rolling[1]);
  const flank = sqrt(.5 * force / width * limits.modulus / (PI * radius)), root = max(...gears.map(g => {
    let most = 0;
    for (let k = 8; k < 60; k++) { const q = g.root + (g.tip - g.root) * k / 79; most = max(most, 6 * force / width * (g.tip - q) / (2 * thickness(g, q)) ** 2); }
    return most;
  }));
  const found = { "Bearing specific load": load, "Bearing p v, lubricated": .5e-3 * load * diameter * omega, "Flank pressure at the pitch point": flank, "Root stress": root };
  return Object.fromEntries(Object.entries(found).map(([name, v], k) => [name, [v, v <= limits.strength[k]]]));
}
// half thickness of a tooth across its axis at a radius
function thickness(g, q) {
  if (q >= g.form) return q * sin(g.halfAngle(q));
  const t = between(t => g.fillet(t)[0] - q, 0, g.last);
  return q * sin(PI / g.z - g.fillet(t)[1]);
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
  const half = .5 * pitch, shrinks = ratio > 1 ? max(min(path[0] + half, 0) ** 2 - min(path[1] - half, 0) ** 2, 0) : 0, squeezed = .5 * width * (1 + drive.z / driven.z) * pitch * shrinks / drive.base;
  verdicts["Trapped volume change"] = [squeezed, squeezed <= limits.trapped * width * drive.m ** 2];
  Object.assign(verdicts, around(values, limits, min(...clearances)));
  if (limits.strength) Object.assign(verdicts, strength(values, limits, { width, volume: 500 * found.displacement_cm3_per_rev / PI, ratio: drive.z / driven.z, rolling, gears: [drive, driven] }));
  return { numbers: found, rules: verdicts, teeth: [drive.z, driven.z], outlines: () => [drive, driven].map(gearOutline), centers: [null, [0, distance]] };
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
  const backlash = 2 * difference * (tight - inv(angle)) * slope, verdicts = { "Contact ratio": [contact, contact >= limits.contact_ratio[0] && contact <= 2.5], "Tip land, pinion": [pinion.land, pinion.land >= limits.tip_land * pinion.m], "Normal backlash": [backlash, backlash > 0] };
  clearances.forEach((v, k) => { verdicts[`Root clearance, ${k ? "ring" : "pinion"}`] = [v, v >= .05 * pinion.m]; });
  const of = name => values[`machine.${name}`];
  Object.assign(verdicts, bearings([["pinion", of("journal_bearings.radial_clearance"), of("journal_bearings.diameter")], ["ring gear", ring("radial_clearance"), ring("outer_diameter")]], limits, min(...clearances)));
  return { numbers: found, rules: verdicts, teeth: [pinion.z], outlines: () => [gearOutline(pinion)], centers: [null, [0, -distance]] };
}

// equal gears whose tips roll through the roots: places of the addendum by the foot of their normal on the pitch circle, from tip
// to pitch circle over 0 to 1: polar angle of the foot, distance from it, inclination of the normal
function addendum(family, { z, r, height, quarter, alpha }) {
  if (family === "arc_involute_arc") { const side = .5 * PI - alpha, base = r * cos(alpha); return [u => [0, height, side * u], u => [quarter * u, height - base * quarter * u, side]]; }
  if (family === "cycloidal") return [u => { const turn = 2 * acos(clip(u, 0, 1)); return [quarter * (1 - turn / PI), r / z * sin(.5 * turn), .5 * (PI - turn)]; }];
  const footed = (x, y, normal) => { const ox = cos(normal), oy = sin(normal), along = x * ox + y * oy, d = along - sqrt(along * along - (x * x + y * y - r * r)), roll = atan2(y - d * oy, x - d * ox); return [roll, d, normal - roll]; };
  if (family === "circular_arc") {
    const tip = r + height, [ex, ey] = [r * cos(quarter), r * sin(quarter)], center = (tip * tip - r * r) / (2 * (tip - ex)), last = atan2(ey, ex - center);
    return [u => footed(center + (tip - center) * cos(last * u), (tip - center) * sin(last * u), last * u)];
  }
  return [u => { const a = quarter * u, q = r + height * cos(z * a), slope = -height * z * sin(z * a); return footed(q * cos(a), q * sin(a), a - atan2(slope, q)); }];
}
function continuousGear(values, { family, limits }) {
  const own = name => values[`machine.gears.${name}`], helix = (own("helix_angle") ?? 0) * DEG, slope = cos(helix), z = own("tooth_count"), m = own("module") / slope, r = .5 * m * z, quarter = .5 * PI / z, arcs = family === "arc_involute_arc";
  const alpha = atan(tan((own("pressure_angle") ?? 0) * DEG) / slope), backlash = own("normal_backlash"), play = .25 * backlash / cos(atan(tan(helix) * cos(arcs ? alpha : 0))), land = own("tip_land") ?? .08 * m, room = arcs ? own("root_clearance") ?? .005 * m : 0, width = own("face_width");
  const height = arcs ? r * cos(alpha) * quarter : family === "cycloidal" ? .5 * m : .5 * own("tip_diameter") - r, pieces = addendum(family, { z, r, height, quarter, alpha });
  const point = ([roll, distance, inclination], mate) => {
    let d = (mate ? -distance : distance) - play;
    if (mate && room) { const inner = roll > 0 ? 0 : 1 - inclination / (.5 * PI - alpha); d -= room * inner ** 2 * (3 - 2 * inner); }
    const a = mate ? 2 * quarter - roll : roll;
    return [r * cos(a) + d * cos(a + inclination), r * sin(a) + d * sin(a + inclination)];
  };
  const wide = u => { const [x, y] = point(pieces[0](u)); return hypot(x, y) * atan2(y, x) - .5 * land; };
  const start = land > 0 ? wide(1) > 0 ? between(wide, 0, 1) : NaN : 0, corner = point(pieces[0](start)), tip = hypot(...corner), root = hypot(...point(pieces[0](0), true));
  // square of the distance of the contact from the pitch point over the quarter pitch
  const roll = [], square = [], steps = 400;
  for (const piece of pieces) for (let k = 0; k <= steps; k++) { const [a, d] = piece(k / steps); roll.push(a); square.push(d * d); }
  const mean = roll.slice(1).reduce((sum, a, k) => sum + .5 * (a - roll[k]) * (square[k] + square[k + 1]), 0) / quarter, volume = tip * tip - r * r - mean;
  const twist = tan(helix) * width / r, overlap = .25 * twist / quarter, contact = .5; // the flanks of a side touch for half a pitch
  let bend = Infinity;
  for (const piece of pieces) for (const mate of [false, true]) for (let k = 0; k <= steps; k++) {
    const [first, last] = [.01 + .97951 * k / steps, .01049 + .97951 * k / steps].map(u => { const place = piece(u); return [...point(place, mate), (mate ? 2 * quarter - place[0] : place[0]) + place[2]]; });
    bend = min(bend, hypot(last[0] - first[0], last[1] - first[1]) / max(abs(last[2] - first[2]), 1e-12));
  }
  const distance = 2 * r, clearance = distance - tip - root, away = abs(overlap - max(Math.round(2 * overlap), 1) / 2);
  const numbers = { displacement_cm3_per_rev: 2e-3 * PI * width * volume, contact_ratio: contact, tip_diameter_mm: 2 * tip, root_diameter_mm: 2 * root, root_clearance_mm: clearance, center_distance_mm: distance, normal_backlash_mm: backlash, face_width_mm: width, flow_ripple_percent: 100 * swing(roll, square, quarter, 2 * overlap) / volume };
  if (helix) Object.assign(numbers, { face_twist_deg: twist / DEG, overlap_ratio: overlap, total_contact_ratio: contact + overlap });
  const rules = { "Total contact ratio": [contact + overlap, contact + overlap >= 1 - 1e-9], "Overlap ratio": [overlap, away <= limits.overlap], "Normal backlash": [4 * play, 4 * play <= limits.continuous_backlash * m], "Smallest radius of curvature": [bend, bend >= limits.curvature * m], "Root clearance": [clearance, clearance > -1e-6] };
  if (helix && values["machine.casing.inlet_angle"] !== undefined) for (const name of ["drive", "driven"]) { const teeth = (2 * PI - (values["machine.casing.inlet_angle"] + values["machine.casing.outlet_angle"]) * DEG - twist) / (4 * quarter); rules[`Teeth that seal along the helix, ${name} gear`] = [teeth, teeth >= 1]; }
  Object.assign(rules, around(values, limits, clearance));
  const outline = () => {
    const half = land > 0 ? [[tip, 0]] : [], count = 10;
    pieces.forEach((piece, j) => { for (let k = 0; k < count; k++) { const first = j ? 0 : start; half.push(point(piece(first + (1 - first) * k / count))); } });
    [...pieces].reverse().forEach(piece => { for (let k = 0; k <= count; k++) half.push(point(piece(1 - k / count), true)); });
    return turned([...half.slice(1, -1).reverse().map(([x, y]) => [x, -y]), ...half], z, 0);
  };
  return { numbers, rules, teeth: [z, z], outlines: () => { const one = outline(); return [one, one]; }, centers: [null, [0, distance]] };
}
// range of the mean of s^2 over so many half pitches of twist: its period is half a pitch, up the addendum and down again
function swing(roll, square, quarter, turns) {
  const steps = 400, half = [];
  for (let k = 0, j = 0; k <= steps; k++) {
    const a = quarter * k / steps;
    while (j < roll.length - 2 && roll[j + 1] < a) j++;
    const d = roll[j + 1] - roll[j];
    half.push(d > 0 ? square[j] + (square[j + 1] - square[j]) * clip((a - roll[j]) / d, 0, 1) : square[j + 1]);
  }
  const period = [...half, ...half.slice(0, -1).reverse()], count = period.length - 1;
  if (!(turns > 1e-6)) return max(...period) - min(...period);
  const swept = [0];
  for (let k = 0; k < count; k++) swept.push(swept[k] + .5 * (period[k] + period[k + 1]) / count);
  const at = x => { const whole = Math.floor(x), place = (x - whole) * count, k = min(Math.floor(place), count - 1); return swept[k] + (place - k) * (swept[k + 1] - swept[k]) + whole * swept[count]; };
  const past = swept.slice(0, -1).map((own, k) => at(k / count + turns) - own);
  return (max(...past) - min(...past)) / turns;
}

// pockets of a gerotor set: what the walls between two throats sweep, from the middle of the throat over the place of its lobe;
// areas: what inner and outer rotor enclose
function gerotor(values, limits, { throat, areas, radii, edge }) {
  const of = name => values[`machine.${name}`], own = name => of(`rotors.${name}`), n = own("inner_tooth_count"), lobes = n + 1, e = own("eccentricity"), width = own("face_width"), ratio = n / lobes;
  const swept = place => { const [x, y] = throat(place); return .5 * (x * x + (y + e) ** 2 - ratio * (x * x + y * y)); };
  const steps = 80, count = steps * lobes, step = 2 * PI / count, s = Array.from({ length: count }, (_, k) => swept(k * step)), half = steps / 2;
  const rate = s.map((_, k) => s[(k + half) % count] - s[(k - half + count) % count]), area = .5 * rate.reduce((sum, v) => sum + abs(v), 0) * step / ratio;
  const flow = Array.from({ length: steps }, (_, k) => { let sum = 0; for (let j = k; j < count; j += steps) sum += max(rate[j], 0); return sum; });
  let grown = 0, middle = 0;
  const growth = rate.map((v, k) => grown += .5 * (v + rate[(k + count - 1) % count]) * step / ratio);
  middle = growth.reduce((a, b) => a + b) / count;
  const mean = (areas[1] - areas[0]) / lobes - middle, pockets = [mean + max(...growth), mean + min(...growth)], [innerTip, innerRoot, outerTip, outerRoot] = radii;
  const ripple = 100 * (max(...flow) - min(...flow)) / (flow.reduce((a, b) => a + b) / steps), gap = .1 * own("tip_clearance") / e, share = 100 * pockets[1] / pockets[0];
  const numbers = { displacement_cm3_per_rev: n * area * width * 1e-3, flow_ripple_percent: ripple, max_pocket_volume_mm3: width * pockets[0], min_pocket_volume_mm3: width * pockets[1], eccentricity_mm: e, face_width_mm: width, inner_tip_diameter_mm: 2 * innerTip, inner_root_diameter_mm: 2 * innerRoot, outer_tip_diameter_mm: 2 * outerTip, outer_root_diameter_mm: 2 * outerRoot };
  const diameter = of("housing.outer_rotor_diameter"), rim = (.5 * diameter - outerRoot) / (outerRoot - outerTip), rules = { "Rim of the outer rotor over the lobe height": [rim, rim > .6 && rim < 6], "Flow ripple": [ripple, ripple < 10], "Smallest pocket over the largest": [share, share < 5], "Tip gap over the eccentricity": [gap, gap < 4] };
  if (edge !== undefined) rules["Smallest convex radius of the inner rotor"] = [edge, edge > .5];
  if (!limits.port_contour) {
    const shaft = .5 * (own("shaft_diameter") ?? innerRoot), outside = 100 * (.5 * diameter - (of("ports.outer_radius") ?? outerRoot)) / (.5 * diameter - outerRoot), inside = 100 * ((of("ports.inner_radius") ?? innerRoot) - shaft) / (innerRoot - shaft);
    rules["Land beside the kidneys to the rim"] = [outside, outside > 50]; rules["Land beside the kidneys to the shaft"] = [inside, inside > 50];
  }
  const carried = [["outer rotor", of("housing.radial_clearance"), diameter]];
  if (of("journal_bearings.diameter") !== undefined) carried.push(["inner rotor", of("journal_bearings.radial_clearance"), of("journal_bearings.diameter")]);
  Object.assign(rules, bearings(carried, limits));
  return { numbers, rules, rotors: true, centers: [[0, -e]] };
}
// lobes of the outer rotor touch the inner one where the line from their centre to the pitch point leaves them
function trochoidalGerotor(values, { limits }) {
  const of = name => values[`machine.rotors.${name}`], n = of("inner_tooth_count"), lobes = n + 1, e = of("eccentricity"), R = of("generating_radius"), q = of("lobe_radius"), gap = .5e-3 * of("tip_clearance");
  const throat = place => { const x = R * sin(place), y = -R * cos(place), dx = -x, dy = -lobes * e - y, l = hypot(dx, dy); return [x + q * dx / l, y + q * dy / l]; };
  let curvature = 0, length = 0;
  for (let k = 0; k < 400; k++) { const t = 2 * PI * k / 400, c = R * R + (lobes * e) ** 2 - 2 * R * lobes * e * cos(t); length += 2 * PI * sqrt(c) / 400; curvature = max(curvature, (R * R + lobes ** 3 * e * e - R * e * lobes * (lobes + 1) * cos(t)) / c ** 1.5); }
  const limit = 1 / curvature, closure = R * sin(PI / lobes), a = q + gap, r = q - gap, floor = R - q + 2 * e + gap, { corner, swing } = cavity({ R, r, floor, lobes });
  const areas = [PI * (R * R + lobes * e * e) - a * length + PI * a * a, lobes * (R * r * sin(swing) - r * r * swing + floor * floor * (PI / lobes - corner))];
  const found = gerotor(values, limits, { throat, areas, radii: [R - q + e - gap, R - q - e - gap, R - r, floor], edge: limit - a });
  found.numbers.no_undercut_limit_mm = limit;
  Object.assign(found.rules, { "Lobe radius over its no-undercut limit": [q / limit, q < .95 * limit], "Lobe radius over half the lobe distance": [q / closure, q < .95 * closure] });
  return { ...found, outlines: () => rotorOutlines({ n, lobes, e, R, q, gap }) };
}
// a lobe touches along the large generating circle, and near the pitch point along the small one
function cycloidalGerotor(values, { limits }) {
  const of = name => values[`machine.rotors.${name}`], n = of("inner_tooth_count"), lobes = n + 1, e = of("eccentricity"), q = .5 * e, large = (2 * n + 1) * q, gap = .5e-3 * of("tip_clearance");
  const throat = place => {
    const rolled = (((place - .5 * PI / lobes) % (2 * PI)) + 2 * PI) % (2 * PI) * 2 * lobes * q, small = rolled > 2 * PI * large, turn = small ? (rolled - 2 * PI * large) / q : rolled / large, radius = small ? q : large;
    return [radius * sin(turn), -lobes * e + radius * (1 - cos(turn))];
  };
  const enclosed = (z, g) => PI * ((z * e) ** 2 + 2 * q * q) + 16 * z * q * g + PI * g * g;
  const found = gerotor(values, limits, { throat, areas: [enclosed(n, -gap), enclosed(lobes, gap)], radii: [(n + 1) * e - gap, (n - 1) * e - gap, (lobes - 1) * e + gap, (lobes + 1) * e + gap] });
  return { ...found, outlines: () => [cycloid(n, q, -gap), cycloid(lobes, q, gap)] };
}
// alternating epi- and hypocycloids, moved along their normals, which meet the pitch circle where the generating circle touches it
function cycloid(z, q, gap) {
  const r = 2 * z * q, count = 13, one = [];
  for (const [side, first] of [[1, 0], [-1, PI / z]]) for (let k = 0; k < count; k++) {
    const t = PI / z * (k + .5) / count, a = first + t, b = first + (side > 0 ? (r + q) * t / q : -(r - q) * t / q), x = (r + side * q) * cos(a) - side * q * cos(b), y = (r + side * q) * sin(a) - side * q * sin(b);
    const dx = side * (x - r * cos(a)), dy = side * (y - r * sin(a)), l = hypot(dx, dy);
    one.push([x + gap * dx / l, y + gap * dy / l]);
  }
  return turned(one, z, -.5 * PI - .5 * PI / z);
}

// outline of a gear, a tooth on the x axis
function gearOutline(g) {
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
// half angles of a lobe between its ends at the floor of the cavities, about the rotor's centre and about its own
const cavity = ({ R, r, floor, lobes }) => ({ corner: min(acos((R * R + floor * floor - r * r) / (2 * R * floor)), PI / lobes), swing: acos((R * R + r * r - floor * floor) / (2 * R * r)) });
// inner rotor and inside of the outer one, each about its own centre
function rotorOutlines({ n, lobes, e, R, q, gap }) {
  const inner = [], start = -.5 * PI + PI / lobes, points = 48 * n, first = (.5 * PI - start) / n; // tips and roots are among the points
  for (let k = 0; k < points; k++) {
    const s = first - 2 * PI * k / points, a = start - s, b = -lobes * s, cx = R * cos(a) - e * sin(b), cy = R * sin(a) + e * cos(b);
    // along the path of the lobe's centre; the profile lies on its inner side
    const dx = R * sin(a) + lobes * e * cos(b), dy = -R * cos(a) + lobes * e * sin(b), l = hypot(dx, dy), r = q + gap;
    inner.push([cx + r * dy / l, cy - r * dx / l]);
  }
  const r = q - gap, floor = R - q + 2 * e + gap, half = PI / lobes, { corner, swing } = cavity({ R, r, floor, lobes }), one = [];
  for (let k = -6; k <= 6; k++) { const t = swing * k / 6; one.push([R - r * cos(t), r * sin(t)]); }
  for (let k = 1; k < 6; k++) { const t = corner + (2 * half - 2 * corner) * k / 6; one.push([floor * cos(t), floor * sin(t)]); }
  return [inner, turned(one, lobes, start)];
}

const FORMS = { external_gear: externalGear, continuous_contact: continuousGear, crescent, trochoidal: trochoidalGerotor, cycloidal: cycloidalGerotor };
// values: keys of the case by path, in their units; null where the machine has no closed form
export function kinematics(closed, values) {
  const form = FORMS[closed?.kind];
  if (!form) return null;
  const found = form({ ...closed.values, ...values }, closed);
  return Object.values(found.numbers).every(Number.isFinite) ? found : null;
}
