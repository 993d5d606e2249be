// A panel that is made of parts, one below the other under titles of their own.
import { section } from "../elements.js";

// `make`: [[id, title, part]], each part a function (place, context) that returns {update(state, changed), show?, hide?}.
// Returns the panel, and `part(id)` for what a part has returned.
export function composed(id, title, make) {
  const parts = new Map();
  const tell = (verb, ...what) => {
    for (const part of parts.values()) part[verb]?.(...what);
  };
  return {
    id,
    title,
    mount(place, context) {
      for (const [name, words, part] of make) parts.set(name, part(section(place, name, words), context));
    },
    update: (state, changed) => tell("update", state, changed),
    show: () => tell("show"),
    hide: () => tell("hide"),
    part: (name) => parts.get(name),
  };
}
