// A field for a number as people type it: with a decimal point or comma, and with another unit than the field's written behind.
// The browser's own number field drops the comma where its language has the point, and made 4849 of 484,9.
import { element } from "./elements.js";

const NUMBER = /^([+\-−]?(?:\d+(?:[.,]\d*)?|[.,]\d+)(?:e[+-]?\d+)?)\s*(\S*)$/i;
const THOUSANDS = /^[+\-−]?[1-9]\d{0,2},\d{3}$/; // or a decimal comma: nobody can tell
/** How many of the first unit one of each is. @type {Record<string, Record<string, number>>} */
const UNITS = {
  mm: { mm: 1, cm: 10, m: 1000, in: 25.4 },
  "°": { "°": 1, deg: 1, rad: 180 / Math.PI },
  kg: { kg: 1, g: 0.001 },
  s: { s: 1, ms: 0.001 },
  Hz: { hz: 1, khz: 1000 },
  "": {},
};

/**
 * The number that a text says, in a unit; or why it says none, to be read behind the text.
 * @param {string} text
 * @param {string} unit of the field, see UNITS; it may be left out
 * @returns {{value: number, fault?: undefined} | {value?: undefined, fault: string}}
 */
export function parseNumber(text, unit = "") {
  const [, digits = "", written = ""] = NUMBER.exec(text.trim()) ?? [];
  if (THOUSANDS.test(digits)) {
    const [point, whole] = [digits.replace(",", "."), digits.replace(",", "")];
    return { fault: `may be ${point} or ${whole}: write one of them` };
  }
  const scale = written ? UNITS[unit][written.toLowerCase()] : 1;
  const value = digits ? Number(digits.replace(",", ".").replace("−", "-")) * (scale ?? Number.NaN) : Number.NaN;
  if (Number.isFinite(value)) return { value: Number(value.toPrecision(12)) };
  const units = Object.keys(UNITS[unit]);
  return { fault: `must be a number${units.length ? `, alone or in ${units.join(", ")}` : ""}` };
}

/**
 * Such a field; the arrow keys change it by its step, as they do the browser's own.
 * @param {{id?: string, min: number, max: number, unit?: string, step?: number, [attribute: string]: any}} attributes
 */
export function numberInput({ min, max, unit = "", step = 1, ...attributes }) {
  const keyboard = min < 0 ? null : "decimal"; // that of a phone for decimals has no sign
  const limits = { "data-min": min, "data-max": max, "data-unit": unit, "data-step": step };
  return element("input", { type: "text", inputmode: keyboard, autocomplete: "off", ...limits, ...attributes });
}

/**
 * The number in a field; or the rule that what stands there breaks, to be read behind it.
 * @param {HTMLInputElement} input
 * @returns {ReturnType<typeof parseNumber>}
 */
export function readNumber({ value: text, dataset }) {
  const [min, max] = [Number(dataset.min), Number(dataset.max)];
  const read = parseNumber(text, dataset.unit);
  if (read.fault !== undefined && text.trim()) return read;
  if (read.value !== undefined && read.value >= min && read.value <= max) return read;
  const unit = dataset.unit && ` ${dataset.unit}`;
  return { fault: `must be a number from ${min} to ${max}${unit}` };
}

/** Let the arrow keys step through the numbers of every such field in the document. @param {EventTarget} place */
export function stepByArrows(place) {
  place.addEventListener("keydown", (event) => {
    const { target: input, key, altKey, ctrlKey, metaKey } = /** @type {KeyboardEvent} */ (event);
    const way = { ArrowUp: 1, ArrowDown: -1 }[key];
    if (!way || altKey || ctrlKey || metaKey || !(input instanceof HTMLInputElement) || !input.dataset.step) return;
    event.preventDefault();
    const { value } = parseNumber(input.value, input.dataset.unit);
    if (value === undefined) return;
    const next = value + way * Number(input.dataset.step);
    const [min, max] = [Number(input.dataset.min), Number(input.dataset.max)];
    input.value = String(Number(Math.min(Math.max(next, min), max).toPrecision(12)));
    for (const type of ["input", "change"]) input.dispatchEvent(new Event(type, { bubbles: true }));
  });
}
