// Elements, and what the server answers.
export const by = id => document.getElementById(id);
export function element(kind, properties = {}, ...children) {
  const made = Object.assign(document.createElement(kind), properties);
  made.append(...children.filter(child => child !== null && child !== undefined));
  return made;
}
export async function ask(path, body, options = {}) {
  const given = body === undefined ? {} : { method: "POST", body: JSON.stringify(body) };
  const answer = await fetch(path, { ...given, ...options });
  if (answer.status === 403) throw new Error("This page is no longer let in: open the address that 'toothspace app' has printed.");
  let found = null;
  try { found = await answer.json(); } catch { throw new Error(`The server answers ${answer.status}.`); }
  if (!answer.ok) throw new Error((found.problems ?? [`The server answers ${answer.status}.`]).map(plainly).join("\n"));
  return found;
}
const plainly = line => line.replace(/ with its unit in quotes, such as '([^']*)'/g, ", such as $1").replace(/^case: /, "");
export function complain(error) {
  const box = by("problems");
  box.textContent = error ? error.message ?? String(error) : "";
  box.hidden = !error;
}
