// A panel that is made of sections, one below the other under titles of their own.
import { section } from "../elements.js";

// `definitions`: [[id, title, create]], where create(place, context) returns {update(state, changed), show?, hide?}.
// Returns the panel; its `section(id)` is what `create` has returned.
export function sectionedPanel(id, title, definitions) {
  const sections = new Map();
  const call = (method, ...values) => {
    for (const one of sections.values()) one[method]?.(...values);
  };
  return {
    id,
    title,
    mount(place, context) {
      for (const [name, heading, create] of definitions)
        sections.set(name, create(section(place, name, heading), context));
    },
    update: (state, changed) => call("update", state, changed),
    show: () => call("show"),
    hide: () => call("hide"),
    section: (name) => sections.get(name),
  };
}
