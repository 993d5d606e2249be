// Numbers and words as the page writes them.

/** @param {number} value @param {number} digits after the point @param {string} unit */
export function formatNumber(value, digits, unit = "") {
  const text = value.toLocaleString("en", {
    minimumFractionDigits: digits,
    maximumFractionDigits: digits,
    signDisplay: "negative",
  });
  return `${text}${unit && `\u202f${unit}`}`;
}

/** A length in millimetres with at least two significant digits, so that only nothing is 0. @param {number} metres */
export function formatLength(metres) {
  const size = Math.abs(1000 * metres);
  const digits = size === 0 || size >= 10 ? 0 : Math.min(1 - Math.floor(Math.log10(size)), 6);
  return formatNumber(1000 * metres, digits, "mm");
}

/** @param {number | null | undefined} share */
export function formatPercent(share) {
  return `${Math.round(100 * (share ?? 0))}\u202f%`;
}

/** A moment of the clock on the wall. @param {number} at_ns [ns] since the Unix epoch; 0: never */
export function formatMoment(at_ns) {
  return at_ns ? new Date(at_ns / 1e6).toLocaleString("en-GB", { dateStyle: "short", timeStyle: "short" }) : "never";
}

/** @param {number} count @param {string} word */
export function pluralize(count, word) {
  return count === 1 ? word : `${word}s`;
}

/** @param {string | null | undefined} words */
export function capitalize(words) {
  return words ? words[0].toUpperCase() + words.slice(1) : "";
}
