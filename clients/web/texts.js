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

/** @param {number | null | undefined} share */
export function formatPercent(share) {
  return `${Math.round(100 * (share ?? 0))}\u202f%`;
}

/** @param {number} count @param {string} word */
export function pluralize(count, word) {
  return count === 1 ? word : `${word}s`;
}

/** @param {string | null | undefined} words */
export function capitalize(words) {
  return words ? words[0].toUpperCase() + words.slice(1) : "";
}
