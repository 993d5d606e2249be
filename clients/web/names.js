// The rule for names of tasks and trackers: that of the service, pattern and sentence alike (teachpath_proto/keys.py).
export const NAME_PATTERN = "(?!.*\\.\\.)[A-Za-z0-9][A-Za-z0-9._-]{0,63}";

const NAME = new RegExp(`^${NAME_PATTERN}$`);

/** @param {string} text */
export const isName = (text) => NAME.test(text);

/**
 * The sentence that refuses `text` as the name of a `what`, e.g. "task"; it tells the whole rule.
 * @param {string} what
 * @param {string} text
 */
export function nameRefusal(what, text) {
  return (
    `'${text.slice(0, 80)}' cannot name a ${what}: use 1 to 64 of the letters a to z and A to Z, digits, '.', '_' and '-'; ` +
    "begin with a letter or digit, and never write '..'"
  );
}
