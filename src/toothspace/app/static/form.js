// All keys of a case, built from its JSON Schema: labels in plain words, the key behind a hover.
import { element } from "./dom.js";

const unquoted = text => text.replace(/`/g, "").replace(/ with its unit in quotes, such as '([^']*)'/g, ", such as $1");
const words = name => { const text = name.replace(/_/g, " "); return text[0].toUpperCase() + text.slice(1); };
const isTable = s => s.properties !== undefined || s.oneOf?.[0]?.properties !== undefined;
const join = (path, name) => path ? `${path}.${name}` : name;

export function buildForm(form, schema, tables, changed) {
  const { base, schema: version, ...properties } = schema.properties;
  form.replaceChildren();
  keys(form, "", { properties, required: ["title"] }, tables, changed);
  form.onsubmit = event => event.preventDefault();
}
function table(path, s, value, name, changed) {
  const box = element("details", { className: "table", open: value !== undefined && path.split(".").length < 2 });
  box.append(element("summary", { title: path }, words(name), " ", element("small", { className: "small", textContent: (s.description ?? "").replace(/\.$/, "") })));
  const inner = element("div"); box.append(inner);
  const fill = () => { if (inner.childElementCount) return; if (s.oneOf) variants(inner, path, s, value, changed); else keys(inner, path, s, value, changed); };
  if (box.open) fill(); else box.addEventListener("toggle", fill, { once: true });
  return box;
}
function variants(inner, path, s, value, changed) {
  const tag = Object.keys(s.oneOf[0].properties).find(k => s.oneOf[0].properties[k].const !== undefined);
  const names = s.oneOf.map(v => v.properties[tag].const), rest = element("div");
  const show = (name, given) => {
    const chosen = s.oneOf[names.indexOf(name)];
    rest.replaceChildren();
    if (!chosen) return;
    const { [tag]: _, ...properties } = chosen.properties;
    keys(rest, path, { ...chosen, properties }, given, changed);
  };
  const line = key(join(path, tag), tag, { description: "Which keys there are.", enum: names }, value?.[tag], true, null);
  line.querySelector("select").onchange = event => show(event.target.value, {});
  inner.append(line, rest);
  show(value?.[tag], value);
}
function keys(inner, path, s, value, changed) {
  const more = element("details", { className: "more" }), rest = element("div");
  for (const [name, one] of Object.entries(s.properties)) {
    const place = join(path, name), given = value?.[name], needed = (s.required ?? []).includes(name);
    if (one.const !== undefined) continue;
    const made = isTable(one) ? table(place, one, given, name, changed) : key(place, name, one, given, needed, changed);
    (given !== undefined || needed ? inner : rest).append(made);
  }
  if (rest.childElementCount) { more.append(element("summary", { textContent: `More keys (${rest.childElementCount})` }), rest); inner.append(more); }
  if (s.additionalProperties?.oneOf) for (const [one, given] of Object.entries(value ?? {})) if (!(one in s.properties)) inner.append(table(join(path, one), s.additionalProperties, given, one, changed));
}
function key(path, name, s, value, required, changed) {
  const options = s.type === "boolean" ? [true, false] : s.enum, id = `key.${path}`;
  let input;
  if (options) input = element("select", {}, element("option", { value: "" }), ...options.map(o => element("option", { value: o, textContent: words(String(o)) })));
  else input = element("input", { type: "text", placeholder: s.default !== undefined && typeof s.default !== "object" ? `default ${s.default}` : s["x-unit"] ? `in ${s["x-unit"]}` : "" });
  input.value = value === undefined ? "" : typeof value === "string" ? value : JSON.stringify(value);
  input.id = id;
  input.setAttribute("aria-describedby", `about.${path}`);
  if (changed) input.onchange = () => changed(path, read(input.value.trim(), s));
  return element("div", { className: "key" }, element("label", { htmlFor: id, title: path, textContent: words(name) + (required ? " *" : "") }), input, element("small", { id: `about.${path}`, textContent: unquoted(s.description ?? "") }));
}
function read(given, s) {
  if (given === "") return null;
  if (s.type === "string" || s.enum?.every(o => typeof o === "string")) return s["x-unit"] ? given.replace(/^([+-]?\d*),(\d)/, "$1.$2") : given;
  try { return JSON.parse(given.replace(/^([+-]?\d+),(\d+)$/, "$1.$2")); } catch { return given; }
}
