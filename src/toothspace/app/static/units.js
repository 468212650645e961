// Units and numbers as the user likes them; cases keep the units of their keys.
const CHOICES = {
  pressure: { bar: ["bar", 1, 0], psi: ["psi", 14.503774, 0], MPa: ["MPa", 0.1, 0] },
  flow: { "L/min": ["L/min", 1, 0], gpm: ["gpm", 0.26417205, 0] },
  temperature: { "°C": ["°C", 1, 0], "°F": ["°F", 1.8, 32] },
  length: { mm: ["mm", 1, 0], inch: ["in", 1 / 25.4, 0] },
};
const KIND = { bar: "pressure", "L/min": "flow", degC: "temperature", "°C": "temperature", mm: "length" };
const SHOWN = { degC: "°C", deg: "°", um: "µm", "mm^2": "mm²", mm2: "mm²", mm3: "mm³", "mm^3": "mm³", "cm^3": "cm³", "1": "" };
const SUFFIXES = [["_cm3_per_rev", "cm³/rev"], ["_L_per_min", "L/min"], ["_percent", "%"], ["_N_m", "N m"], ["_degC", "degC"], ["_bar", "bar"], ["_rpm", "rpm"], ["_mm3", "mm3"], ["_mm", "mm"], ["_um", "um"], ["_deg", "deg"], ["_dBA", "dB(A)"], ["_W", "W"], ["_N", "N"], ["_s", "s"]];
export const units = JSON.parse(localStorage.getItem("units") ?? "{}");
for (const kind in CHOICES) units[kind] ??= Object.keys(CHOICES[kind])[0];
units.numbers ??= (navigator.language ?? "en").startsWith("de") ? "1,5" : "1.5";
units.theme ??= matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light";
export function keepUnits() { localStorage.setItem("units", JSON.stringify(units)); }

const chosen = unit => KIND[unit] ? CHOICES[KIND[unit]][units[KIND[unit]]] : [SHOWN[unit] ?? unit, 1, 0];
export const unitShown = unit => chosen(unit)[0];
export const toShown = (value, unit) => value * chosen(unit)[1] + chosen(unit)[2];
export const fromShown = (value, unit) => (value - chosen(unit)[2]) / chosen(unit)[1];
export const factor = unit => chosen(unit)[1];
export function text(value, digits = 4) {
  if (value === null || value === undefined || Number.isNaN(value)) return "–";
  const plain = value === 0 ? "0" : Math.abs(value) >= 1e5 || Math.abs(value) < 1e-4 ? value.toExponential(digits - 1) : String(Number(value.toPrecision(digits)));
  return units.numbers === "1,5" ? plain.replace(".", ",") : plain;
}
export const fixed = (value, places) => units.numbers === "1,5" ? value.toFixed(places).replace(".", ",") : value.toFixed(places);
// a text of the program with values in its units, in those of the user
export const pretty = told => told.replace(/(-?\d+(?:\.\d+)?(?:e[+-]?\d+)?) (bar|mm2|mm3|mm|um|degC|deg|L\/min)\b/g, (_, value, unit) => `${text(toShown(Number(value), unit))}${unit === "deg" ? "" : " "}${unitShown(unit)}`);
export const number = given => Number(String(given).trim().replace(/\s/g, "").replace(",", "."));
// names of numbers where the words of the key would not tell, from the program's own table
let told = { names: {}, beginnings: {} };
export function keepWords(found) { told = found; }
export function named(key) {
  const [suffix, unit] = SUFFIXES.find(([s]) => key.endsWith(s)) ?? ["", ""], stem = key.slice(0, key.length - suffix.length);
  const beginning = Object.keys(told.beginnings).filter(b => stem.startsWith(b)).sort((a, b) => b.length - a.length)[0];
  const words = told.names[stem] ?? (beginning ? `${told.beginnings[beginning]}, ${stem.slice(beginning.length)}` : stem).replace(/_/g, " ");
  return { label: words[0].toUpperCase() + words.slice(1), unit };
}
export function settingsForm(form, done) {
  const rows = [...Object.entries(CHOICES).map(([kind, all]) => [kind, Object.keys(all)]), ["numbers", ["1.5", "1,5"]], ["theme", ["light", "dark"]]];
  form.replaceChildren(Object.assign(document.createElement("h2"), { textContent: "Units and numbers" }), ...rows.map(([kind, names]) => {
    const label = document.createElement("label"), select = document.createElement("select");
    label.append(kind[0].toUpperCase() + kind.slice(1), select);
    select.append(...names.map(name => new Option(name, name, false, units[kind] === name)));
    select.onchange = () => { units[kind] = select.value; keepUnits(); done(); };
    return label;
  }), Object.assign(document.createElement("button"), { textContent: "Close", className: "first" }));
}
