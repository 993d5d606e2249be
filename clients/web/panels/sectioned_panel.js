// A panel that is made of sections, one below the other under titles of their own.
import { section } from "../elements.js";

/** @typedef {[id: string, title: string, create: (place: HTMLElement, context: Context) => Section]} SectionDefinition */

/**
 * @param {string} id
 * @param {string} title
 * @param {SectionDefinition[]} definitions
 * @returns {Panel}
 */
export function sectionedPanel(id, title, definitions) {
  /** @type {Section[]} */
  const sections = [];
  return {
    id,
    title,
    mount(place, context) {
      for (const [name, heading, create] of definitions) {
        sections.push(create(section(place, name, heading), context));
      }
    },
    update(state, changed) {
      for (const one of sections) one.update(state, changed);
    },
    show() {
      for (const one of sections) one.show?.();
    },
    hide() {
      for (const one of sections) one.hide?.();
    },
  };
}
