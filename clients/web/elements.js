// Small makers of elements and texts.

/** @typedef {Record<string, string | number | boolean | null | undefined>} Attributes */

/**
 * An element with attributes and children; attributes and children that are false, null or "" are left out.
 * @template {keyof HTMLElementTagNameMap} Tag
 * @param {Tag} tag
 * @param {Attributes} attributes
 * @param {...Child} children
 */
export function element(tag, attributes, ...children) {
  const made = document.createElement(tag);
  fillElement(made, attributes, children);
  return made;
}

/**
 * The same for drawings.
 * @template {keyof SVGElementTagNameMap} Tag
 * @param {Tag} tag
 * @param {Attributes} attributes
 * @param {...Child} children
 */
export function svgElement(tag, attributes, ...children) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  fillElement(made, attributes, children);
  return made;
}

/** @param {Element} made @param {Attributes} attributes @param {Child[]} children */
function fillElement(made, attributes, children) {
  for (const [name, value] of Object.entries(attributes)) {
    if (value !== false && value !== null && value !== undefined) made.setAttribute(name, String(value));
  }
  made.append(...flatten(children));
}

/**
 * @param {Child[]} children
 * @returns {(Node | string)[]}
 */
function flatten(children) {
  return children.flatMap((child) => {
    if (Array.isArray(child)) return flatten(child);
    if (child instanceof Node) return [child];
    return child || child === 0 ? [String(child)] : [];
  });
}

/**
 * The element that an event came from, or the nearest around it, that a selector fits; null when there is none.
 * @param {Event} event
 * @param {string} selector
 */
export function closest(event, selector) {
  return event.target instanceof Element ? event.target.closest(selector) : null;
}

/**
 * The data of the button that was pressed, or of what else `selector` fits; without one, no data.
 * @param {Event} event
 * @param {string} selector
 * @returns {Partial<DOMStringMap>}
 */
export function closestData(event, selector = "button") {
  const found = closest(event, selector);
  return found instanceof HTMLElement || found instanceof SVGElement ? found.dataset : {};
}

/**
 * An option of a select: its value, and what it says.
 * @param {string | number} value
 * @param {string} text
 */
export const option = (value, text = String(value)) => element("option", { value }, text);

/**
 * Names with their values; a pair without a value is left out, and what is no pair.
 * @param {Fact[]} facts
 */
export function definitionList(facts) {
  const pairs = facts.flatMap((fact) => (fact ? [fact] : [])).filter(([, value]) => value);
  const rows = pairs.map(([name, value]) => [element("dt", {}, name), element("dd", {}, value)]);
  return element("dl", {}, rows);
}

const MOST_UNFINISHED = 0.97; // of a bar: while anything is waited for, a part of it is open

/** @param {number | undefined} share @param {string} label @param {boolean} isOver whether nothing is waited for any more */
export function progressBar(share, label, isOver = false) {
  const shown = isOver ? (share ?? 0) : Math.min(share ?? 0, MOST_UNFINISHED);
  return element("progress", { max: "1", value: String(shown), "aria-label": label });
}

/**
 * Attributes of a control that cannot be used now: it says why.
 * @param {string} why "": it can be used
 */
export const blocked = (why) => (why ? { disabled: "", title: why } : {});

/**
 * Let a control that stays not be used, and say why; or let it be used again.
 * @param {HTMLButtonElement | HTMLInputElement | HTMLSelectElement} control
 * @param {string} why "": it can be used
 * @param {string} title what it says of itself then
 */
export function block(control, why, title = "") {
  control.disabled = why !== "";
  control.title = why || title;
}

/** @param {string} text */
export function hint(text) {
  return element("p", { class: "hint" }, text);
}

/**
 * A button that opens another tab: the next step of who is in the wrong one.
 * @param {string} tab
 * @param {string} text
 */
export function tabButton(tab, text) {
  const attributes = { type: "button", class: "primary", "data-open": tab, "data-key": `open ${tab}` };
  return element("p", { class: "buttons" }, element("button", attributes, text));
}

/** @param {string} text */
export function codeBlock(text) {
  return element("pre", {}, element("code", {}, text));
}

/**
 * A titled part of a panel; returns where its content goes.
 * @param {HTMLElement} parent
 * @param {string} id
 * @param {string} title
 */
export function section(parent, id, title) {
  const body = element("div", { id });
  parent.append(element("section", {}, element("h2", {}, title), body));
  return body;
}

/**
 * A part of a panel that is folded until somebody wants it; returns where its content goes.
 * @param {HTMLElement} parent
 * @param {string} id
 * @param {string} title
 */
export function foldedSection(parent, id, title) {
  const body = element("div", { id });
  const head = element("summary", {}, element("h2", {}, title));
  parent.append(element("section", { class: "folded" }, element("details", {}, head, body)));
  return body;
}

/**
 * Hide the whole section whose content stands in `place`, with its title.
 * @param {HTMLElement} place
 * @param {boolean} hidden
 */
export function hideSection(place, hidden) {
  if (place.parentElement) place.parentElement.hidden = hidden;
}
