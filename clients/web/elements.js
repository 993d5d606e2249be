// Small makers of elements and texts.

// An element with attributes and children; attributes and children that are false, null or "" are left out.
export function element(tag, attributes, ...children) {
  const made = document.createElement(tag);
  fillElement(made, attributes, children);
  return made;
}

// The same for drawings.
export function svgElement(tag, attributes, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  fillElement(made, attributes, children);
  return made;
}

function fillElement(made, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children.flat(3).filter((child) => child || child === 0));
}

// Make what is in `parent` look like `children`, and change only what differs: selections, scroll positions and the
// focus survive, and a button that is pressed while the figures beside it change is still the one that is let go.
// What has another tag or data-key is another thing.
export function patchChildren(parent, ...children) {
  const fresh = document.createElement("div");
  fresh.append(...children.flat(3).filter(Boolean));
  const key = parent.contains(document.activeElement) && document.activeElement.dataset.key;
  patchNodes(parent, fresh);
  if (key && document.activeElement?.dataset.key !== key)
    parent.querySelector(`[data-key="${CSS.escape(key)}"]`)?.focus();
}

function patchNodes(parent, fresh) {
  const wanted = [...fresh.childNodes];
  wanted.forEach((want, i) => {
    const here = parent.childNodes[i];
    if (!here) parent.append(want);
    else if (!here.isEqualNode(want)) patchNode(here, want);
  });
  while (parent.childNodes.length > wanted.length) parent.lastChild.remove();
}

function patchNode(here, want) {
  const same = here.nodeName === want.nodeName && here.dataset?.key === want.dataset?.key;
  if (!same || here.nodeName === "SELECT") {
    here.replaceWith(want); // what a list has chosen is no attribute
  } else if (here.nodeType === Node.TEXT_NODE) {
    here.data = want.data;
  } else {
    for (const { name } of [...here.attributes]) if (!want.hasAttribute(name)) here.removeAttribute(name);
    for (const { name, value } of want.attributes)
      if (here.getAttribute(name) !== value) here.setAttribute(name, value);
    patchNodes(here, want);
  }
}

export function formatNumber(value, digits, unit = "") {
  const figures = { minimumFractionDigits: digits, maximumFractionDigits: digits, signDisplay: "negative" };
  return `${value.toLocaleString("en", figures)}${unit && `\u202f${unit}`}`;
}

export function formatPercent(share) {
  return `${Math.round(100 * (share ?? 0))}\u202f%`;
}

export function pluralize(count, word) {
  return count === 1 ? word : `${word}s`;
}

export function capitalize(words) {
  return words ? words[0].toUpperCase() + words.slice(1) : "";
}

// Names with their values; a pair without a value is left out, and what is no pair.
export function definitionList(pairs) {
  const shown = pairs.filter((pair) => pair?.[1]);
  return element(
    "dl",
    {},
    shown.map(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]),
  );
}

export function progressBar(share, label) {
  return element("progress", { max: "1", value: String(share ?? 0), "aria-label": label });
}

export function hint(text) {
  return element("p", { class: "hint" }, text);
}

// A button that opens another tab: the next step of who is in the wrong one.
export function tabButton(tab, text) {
  return element(
    "p",
    { class: "buttons" },
    element("button", { type: "button", class: "primary", "data-open": tab, "data-key": `open ${tab}` }, text),
  );
}

export function codeBlock(text) {
  return element("pre", {}, element("code", {}, text));
}

// A titled part of a panel; returns where its content goes.
export function section(parent, id, title) {
  const body = element("div", { id });
  parent.append(element("section", {}, element("h2", {}, title), body));
  return body;
}
