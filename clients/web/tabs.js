// Tabs after the ARIA pattern: arrow keys, Home and End move, the chosen tab's panel shows, the others are hidden.
import { element } from "./elements.js";

export class Tabs {
  #tabs = new Map();

  // `chosen(id)` is called when another tab is chosen.
  constructor(list, panels, onSelect = () => {}) {
    Object.assign(this, { list, panels, onSelect });
    list.setAttribute("role", "tablist");
    list.addEventListener("keydown", (event) => this.#onKey(event));
  }

  // Adds a tab and returns the element of its panel.
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
    this.#tabs.set(id, { tab, panel });
    if (!this.current) this.select(id);
    else this.#render();
    return panel;
  }

  select(id) {
    if (id === this.current || !this.#tabs.has(id)) return;
    if (this.current) this.#tabs.get(this.current).scrolled = this.panels.scrollTop; // every tab stays where it was left
    this.current = id;
    this.#render();
    this.panels.scrollTop = this.#tabs.get(id).scrolled ?? 0;
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

  #onKey(event) {
    const ids = [...this.#tabs.keys()];
    const here = ids.indexOf(this.current);
    const next = { ArrowRight: here + 1, ArrowLeft: here - 1, Home: 0, End: ids.length - 1 }[event.key];
    if (next === undefined) return;
    event.preventDefault();
    const id = ids[(next + ids.length) % ids.length];
    this.select(id);
    this.#tabs.get(id).tab.focus();
  }
}
