// Small makers of elements and texts.

// An element with attributes and children; children that are false, null or "" are left out.
export function element(tag, attributes, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  made.append(...children.filter(Boolean));
  return made;
}

// Replace what is in `parent`, but only when it looks different: selections and scroll positions survive.
export function replace(parent, ...children) {
  const fresh = document.createElement("div");
  fresh.append(...children.filter(Boolean));
  if (parent.innerHTML !== fresh.innerHTML) parent.replaceChildren(...fresh.childNodes);
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
