// What people call a task, beside its name: the name that is made of it, as the service makes it (teachpath_proto/display_names.py).
import { option } from "./elements.js";
import { isName } from "./names.js";

export const MAX_LENGTH = 80; // characters
const MAX_ID_LENGTH = 64;

/** @type {Record<string, string>} */
const SPELLINGS = {
  ä: "ae",
  ö: "oe",
  ü: "ue",
  ß: "ss",
  æ: "ae",
  œ: "oe",
  ø: "oe",
  å: "aa",
  ł: "l",
  đ: "d",
  ð: "d",
  þ: "th",
  ı: "i",
};

/**
 * The name that a thing gets which people call `text`; "": no letter or digit is in it.
 * @param {string} text
 */
export function idOf(text) {
  const composed = text.trim().normalize("NFC");
  if (isName(composed)) return composed;
  const spelled = [...composed.toLowerCase()].map((letter) => SPELLINGS[letter] ?? letter).join("");
  const plain = [...spelled.normalize("NFKD").replace(/\p{M}/gu, "")].map(piece).join("");
  return trimmed(trimmed(plain.replace(/-+/g, "-").replace(/\.{2,}/g, ".")).slice(0, MAX_ID_LENGTH));
}

/** @param {string} letter */
function piece(letter) {
  if (/[a-z0-9._-]/.test(letter)) return letter;
  return /[\p{L}\p{N}]/u.test(letter) ? `u${letter.codePointAt(0)?.toString(16)}` : "-";
}

/** @param {string} text */
const trimmed = (text) => text.replace(/^[-._]+|[-._]+$/g, "");

/** What a service is told of a thing that people call `text`. @param {string} text */
export const displayNameOf = (text) => (idOf(text) === text.trim() ? "" : text.trim());

/**
 * What a task is called.
 * @param {Pick<Task, "name" | "display_name">[] | null} tasks
 * @param {string} name
 */
export const taskTitle = (tasks, name) => tasks?.find((task) => task.name === name)?.display_name || name;

/** What a thing is called. @param {{name: string, display_name?: string}} thing */
export const titleOf = ({ name, display_name }) => display_name || name;

/**
 * Let a select offer things as they are called; those that it offers already stay.
 * @param {HTMLSelectElement} select
 * @param {{name: string, display_name?: string}[]} things
 */
export function offerNamed(select, things) {
  const options = things.map((thing) => option(thing.name, titleOf(thing)));
  /** @param {HTMLOptionElement[]} all */
  const content = (all) => all.map(({ value, text }) => `${value} ${text}`).join("\n");
  if (content([...select.options]) !== content(options)) select.replaceChildren(...options);
}

/**
 * Let a field take the name of a thing, and say below it which name is made of what is typed, where that is another.
 * @param {HTMLInputElement} field
 * @param {HTMLElement} note
 */
export function nameField(field, note) {
  field.maxLength = MAX_LENGTH;
  const update = () => {
    const text = field.value.trim();
    const id = idOf(text);
    field.setCustomValidity(text === "" || id ? "" : "Write at least one letter or digit.");
    note.textContent = id && id !== text ? `In addresses and commands: ${id}` : "";
  };
  field.addEventListener("input", update);
  return update;
}
