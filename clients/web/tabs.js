// Tabs after the ARIA pattern: arrow keys, Home and End move, the chosen tab's panel shows, the others are hidden.
import { element } from "./elements.js";

export class Tabs {
  /** @type {Map<string, {tab: HTMLButtonElement, tick: HTMLElement, panel: HTMLDivElement, scrolled: number}>} */
  #tabs = new Map();
  current = "";

  /**
   * @param {HTMLElement} list
   * @param {HTMLElement} panels
   * @param {(id: string) => void} onSelect called when another tab is selected
   */
  constructor(list, panels, onSelect = () => {}) {
    this.list = list;
    this.panels = panels;
    this.onSelect = onSelect;
    list.setAttribute("role", "tablist");
    list.addEventListener("keydown", (event) => this.#onKey(event));
  }

  /**
   * Add a tab and return the element of its panel.
   * @param {string} id
   * @param {string} title
   */
  add(id, title) {
    const tab = element(
      "button",
      { type: "button", role: "tab", id: `tab-${id}`, "aria-controls": `panel-${id}` },
      title,
    );
    const panel = element("div", {
      role: "tabpanel",
      id: `panel-${id}`,
      "aria-labelledby": `tab-${id}`,
      tabindex: "0",
    });
    tab.addEventListener("click", () => this.select(id));
    this.list.append(tab);
    this.panels.append(panel);
    const tick = element("span", { class: "tick", role: "img", "aria-label": "done" }, " ✓");
    this.#tabs.set(id, { tab, tick, panel, scrolled: 0 });
    if (!this.current) this.select(id);
    else this.#render();
    return panel;
  }

  /** Put a tick behind those whose work is done. @param {Set<string>} done ids */
  setDone(done) {
    for (const [id, { tab, tick }] of this.#tabs) {
      if (done.has(id)) tab.append(tick);
      else tick.remove();
    }
  }

  /** @param {string} id */
  select(id) {
    const [next, before] = [this.#tabs.get(id), this.#tabs.get(this.current)];
    if (next === before || !next) return;
    if (before) before.scrolled = this.panels.scrollTop; // every tab stays where it was left
    this.current = id;
    this.#render();
    this.panels.scrollTop = next.scrolled;
    // On a phone the page scrolls as a whole: a panel begins with its begin, not where the one before was read.
    if (this.panels.getBoundingClientRect().top < 0) this.panels.scrollIntoView();
    this.onSelect(id);
  }

  #render() {
    for (const [id, { tab, panel }] of this.#tabs) {
      const here = id === this.current;
      tab.setAttribute("aria-selected", String(here));
      tab.tabIndex = here ? 0 : -1;
      panel.hidden = !here;
    }
  }

  /** @param {KeyboardEvent} event */
  #onKey(event) {
    const ids = [...this.#tabs.keys()];
    const here = ids.indexOf(this.current);
    const targets = new Map([
      ["ArrowRight", here + 1],
      ["ArrowLeft", here - 1],
      ["Home", 0],
      ["End", ids.length - 1],
    ]);
    const next = targets.get(event.key);
    if (next === undefined) return;
    event.preventDefault();
    const id = ids[(next + ids.length) % ids.length];
    this.select(id);
    this.#tabs.get(id)?.tab.focus();
  }
}
