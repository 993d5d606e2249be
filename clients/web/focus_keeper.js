// Keeps the keyboard where the work is: when what has the focus is taken away, hidden or disabled, the focus goes to what is
// next to it, and back once that can have it again: from Start to Hold, and at the end of the motion back to Start. A browser
// would give it to the page as a whole, from where one begins anew.

const FOCUSABLE = "a[href], button, input:not([type=hidden]), select, textarea, summary, [tabindex='0']";
const REGIONS = "section, dialog, [popover], header, [role=tabpanel]"; // that the focus does not leave by itself

/** Keep the focus from now on. */
export function keepFocus() {
  /** @type {Element | null} */
  let last = null; // that had the focus; null: somebody has put it away
  /** @type {Element[]} */
  let around = []; // what it stood in, innermost first: it may be taken out
  let hasMoved = false; // while a key is held
  /** @type {Element[]} */
  let lenders = []; // it goes back to them, newest first
  /** @type {Element | null} */
  let heir = null; // that was given it

  document.addEventListener("focusin", ({ target }) => {
    last = target instanceof Element ? target : null;
    around = last ? ancestors(last) : [];
    if (last !== heir) lenders = []; // somebody has gone on
  });
  document.addEventListener("focusout", ({ relatedTarget }) => {
    if (relatedTarget === null && last && mayHaveFocus(last)) last = null;
  });
  new MutationObserver(() => {
    if (!last || mayHaveFocus(last)) return;
    const back = lenders.findLastIndex((one) => mayHaveFocus(one) && one.checkVisibility());
    const next = back < 0 ? neighbour(last, around) : lenders[back];
    lenders = back < 0 ? [...lenders, last] : lenders.slice(0, back);
    last = null;
    heir = next;
    hasMoved = true;
    if (next instanceof HTMLElement) next.focus();
  }).observe(document.body, {
    subtree: true,
    childList: true,
    attributes: true,
    attributeFilter: ["hidden", "disabled", "inert"],
  });
  // A key that is still held was meant for what was there before.
  addEventListener(
    "keydown",
    (event) => {
      if (!event.repeat) hasMoved = false;
      if (!hasMoved) return;
      event.preventDefault();
      event.stopPropagation();
    },
    { capture: true },
  );
}

/** @param {Element} element @returns {Element[]} */
const ancestors = ({ parentElement: parent }) => (parent ? [parent, ...ancestors(parent)] : []);

/** @param {Element} element */
const isShown = (element) => element.isConnected && element.closest("[hidden], [inert]") === null;

/** @param {Element} element */
const mayHaveFocus = (element) => isShown(element) && !element.matches(":disabled");

/**
 * What takes the focus instead of an element: what follows it in its part of the page, else what is before it.
 * @param {Element} gone
 * @param {Element[]} around what it stood in
 */
function neighbour(gone, around) {
  const tab = document.querySelector("[role=tabpanel]:not([hidden])");
  if (gone.closest("[role=tabpanel][hidden]")) return /** @type {HTMLElement | null} */ (tab);
  const kept = around.find(isShown) ?? document.body;
  const from = gone.isConnected ? gone : kept;
  const part = kept.closest(REGIONS) ?? kept;
  const candidates = [.../** @type {NodeListOf<HTMLElement>} */ (part.querySelectorAll(FOCUSABLE))].filter(
    (one) => mayHaveFocus(one) && one.tabIndex >= 0 && one.checkVisibility(),
  );
  const after = candidates.find((one) => isBehind(one, from));
  return after ?? candidates.at(-1) ?? /** @type {HTMLElement | null} */ (part.closest("[role=tabpanel]") ?? tab);
}

/** @param {Element} one @param {Element} other */
const isBehind = (one, other) => Boolean(other.compareDocumentPosition(one) & Node.DOCUMENT_POSITION_FOLLOWING);
