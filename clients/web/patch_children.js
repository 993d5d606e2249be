// Changes what is drawn as little as possible: selections, scroll positions and the focus survive, and a button that is
// pressed while the figures beside it change is still the one that is let go.
import { element } from "./elements.js";

/**
 * Make what is in `parent` look like `children`. What has another tag or data-key is another thing.
 * @param {HTMLElement} parent
 * @param {...Child} children
 */
export function patchChildren(parent, ...children) {
  const fresh = element("div", {}, children);
  const key = parent.contains(document.activeElement) ? focusedKey() : undefined;
  patchNodes(parent, fresh);
  if (!key || focusedKey() === key) return;
  const same = parent.querySelector(`[data-key="${CSS.escape(key)}"]`);
  if (same instanceof HTMLElement) same.focus();
}

function focusedKey() {
  return document.activeElement instanceof HTMLElement ? document.activeElement.dataset.key : undefined;
}

/** @param {Node} parent @param {Node} fresh */
function patchNodes(parent, fresh) {
  const wanted = [...fresh.childNodes];
  for (const [i, want] of wanted.entries()) {
    const here = parent.childNodes[i];
    if (!here) parent.appendChild(want);
    else if (!here.isEqualNode(want)) patchNode(here, want);
  }
  for (const rest of [...parent.childNodes].slice(wanted.length)) rest.remove();
}

/** @param {ChildNode} here @param {ChildNode} want */
function patchNode(here, want) {
  if (here instanceof Text && want instanceof Text) here.data = want.data;
  else if (here instanceof Element && want instanceof Element && isSame(here, want)) {
    for (const { name } of [...here.attributes]) {
      if (!want.hasAttribute(name) && !isUnfolded(here, name)) here.removeAttribute(name);
    }
    for (const { name, value } of want.attributes) {
      if (here.getAttribute(name) !== value) here.setAttribute(name, value);
    }
    patchNodes(here, want);
  } else here.replaceWith(want);
}

/**
 * Whether an attribute says that somebody has unfolded details, which stay so.
 * @param {Element} here
 * @param {string} name
 */
function isUnfolded(here, name) {
  return here.nodeName === "DETAILS" && name === "open";
}

/**
 * Whether `here` may be made into `want`; what a list has selected is no attribute, so that a list never is.
 * @param {Element} here
 * @param {Element} want
 */
function isSame(here, want) {
  const sameKey = here.getAttribute("data-key") === want.getAttribute("data-key");
  return here.nodeName === want.nodeName && here.nodeName !== "SELECT" && sameKey;
}
