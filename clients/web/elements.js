// Small makers of elements and texts.

// An element with attributes and children; attributes and children that are false, null or "" are left out.
export function element(tag, attributes, ...children) {
  const made = document.createElement(tag);
  fill(made, attributes, children);
  return made;
}

// The same for drawings.
export function drawing(tag, attributes, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  fill(made, attributes, children);
  return made;
}

function fill(made, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children.flat(3).filter((child) => child || child === 0));
}

// Replace what is in `parent`, but only when it looks different: selections and scroll positions survive, and so does
// the focus, on the element with the same data-key.
export function replace(parent, ...children) {
  const fresh = document.createElement("div");
  fresh.append(...children.flat(3).filter(Boolean));
  if (parent.innerHTML === fresh.innerHTML) return;
  const key = parent.contains(document.activeElement) && document.activeElement.dataset.key;
  parent.replaceChildren(...fresh.childNodes);
  if (key) parent.querySelector(`[data-key="${CSS.escape(key)}"]`)?.focus();
}

export function number(value, digits, unit = "") {
  return `${value.toLocaleString("en", { minimumFractionDigits: digits, maximumFractionDigits: digits })}${unit && "\u202f" + unit}`;
}

export function percent(share) {
  return `${Math.round(100 * (share ?? 0))}\u202f%`;
}

export function plural(count, word) {
  return count === 1 ? word : `${word}s`;
}

export function sentence(words) {
  return words ? words[0].toUpperCase() + words.slice(1) : "";
}

// Names with their values; a pair without a value is left out, and what is no pair.
export function facts(pairs) {
  const shown = pairs.filter((pair) => pair && pair[1]);
  return element("dl", {}, shown.map(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]));
}

export function bar(share, label) {
  return element("progress", { max: "1", value: String(share ?? 0), "aria-label": label });
}

export function hint(text) {
  return element("p", { class: "hint" }, text);
}

export function command(text) {
  return element("pre", {}, element("code", {}, text));
}

// A titled part of a panel; returns where its content goes.
export function section(parent, id, title) {
  const body = element("div", { id });
  parent.append(element("section", {}, element("h2", {}, title), body));
  return body;
}
