// Saving a scene: under which name, by whom and why; and removing it. Each can be undone.
import { get, put, remove, resourcePath } from "../api.js";
import { displayNameOf, idOf, MAX_LENGTH, titleOf } from "../display_names.js";
import { block, element } from "../elements.js";
import { icon } from "../icons.js";
import { sceneBody } from "./scene_draft.js";

/** @typedef {import("./scene_draft.js").SceneDraft} SceneDraft */

const PLANS = "Ways that were certified in the version before do not start in this one: certify them again.";
const FORM = "scene-form";
const LAST_SCENE_SENTENCE = "A station needs a scene: make another one first.";
const UNCHANGED_SENTENCE = "Nothing was changed since this version.";
const AUTHOR_KEY = "operator"; // who works at this browser, also for control of the arm

export class SceneSaving {
  isBusy = false; // what the service has may be newer than what the draft knows of it

  /**
   * @param {HTMLElement} place
   * @param {HTMLElement} foot where its button goes, always in view
   * @param {Context} context
   * @param {(name: string) => Promise<void>} reopen shows a scene as the service has it, after it was saved
   */
  constructor(place, foot, { messages, attempt }, reopen) {
    this.messages = messages;
    this.reopen = reopen;
    /** @type {SceneDraft | null} */
    this.draft = null;
    this.name = textInput("save-name", MAX_LENGTH);
    this.author = textInput("author", 80);
    this.note = textInput("note", 2000);
    this.author.value = localStorage.getItem(AUTHOR_KEY) ?? "";
    this.verb = document.createTextNode("");
    this.button = element(
      "button",
      { type: "submit", id: "scene-save", form: FORM, class: "primary" },
      icon("save"),
      this.verb,
    );
    const fields = Object.entries({ "Save as": this.name, Author: this.author, Note: this.note });
    const form = element(
      "form",
      { id: FORM, class: "saving" },
      fields.map(([text, input]) => element("label", {}, text, input)),
    );
    this.removal = element("button", { type: "button", id: "scene-remove" }, "Remove the scene");
    place.append(form, element("p", { class: "buttons" }, this.removal));
    foot.append(this.button);
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      const { draft } = this;
      if (draft) attempt(() => this.#save(draft));
    });
    this.removal.addEventListener("click", () => {
      const { draft } = this;
      if (draft) attempt(() => this.#remove(draft));
    });
  }

  /** Whether it would be saved as another scene. */
  get isOther() {
    return this.draft !== null && this.#wanted(this.draft) !== this.draft.name;
  }

  /** The name of the scene that it would be saved as. @param {SceneDraft} draft */
  #wanted(draft) {
    const called = this.name.value.trim();
    return called === titleOf(draft.original) ? draft.name : idOf(called);
  }

  /**
   * @param {SceneDraft | null} draft
   * @param {string} missing what somebody may not do here; "": nothing
   * @param {boolean} isLast whether there is no other scene
   */
  show(draft, missing, isLast) {
    if (draft && draft.name !== this.draft?.name) this.name.value = titleOf(draft.original);
    this.draft = draft;
    block(this.button, missing || (draft?.isEdited || this.isOther ? "" : UNCHANGED_SENTENCE));
    block(this.removal, missing || (isLast ? LAST_SCENE_SENTENCE : ""));
    this.verb.data = this.isOther ? "Save as another scene" : "Save version";
  }

  /** @param {SceneDraft} draft a refusal leaves it as it is */
  async #save(draft) {
    const [wanted, before, called] = [this.#wanted(draft), draft.original, this.name.value.trim()];
    if (!wanted) throw new Error("Write at least one letter or digit as the scene's name.");
    const [author, note] = [this.author.value, this.note.value];
    localStorage.setItem(AUTHOR_KEY, author);
    const isOther = wanted !== draft.name;
    const scene = isOther ? { ...draft.scene, display_name: displayNameOf(called) } : draft.scene;
    const place = resourcePath("scenes", wanted);
    /** @type {SceneVersion} */
    const saved = await this.#order(async () => {
      const answer = await put(place, sceneBody(scene, { author, note, base: isOther ? 0 : draft.base }));
      if (isOther) draft.revert();
      else draft.saved(answer.number, scene);
      return answer;
    });
    this.note.value = "";
    await this.reopen(wanted);
    const undo = async () => {
      const details = { author, note: `as it was before version ${saved.number}`, base: saved.number };
      await this.#order(async () => {
        if (isOther) return remove(place);
        const { number } = await put(place, sceneBody(before, details));
        draft.saved(number, before);
        return draft.revert();
      });
      await this.reopen(draft.name);
      this.messages.show(isOther ? `Scene ${called} is removed.` : `Scene ${called} is as it was before.`);
    };
    const said = isOther ? `Scene ${called} is made.` : `Saved as version ${saved.number} of scene ${called}. ${PLANS}`;
    this.messages.show(said, "note", { label: "Undo", order: undo });
  }

  /** Remove a scene as the service has it. @param {SceneDraft} draft what was changed in it waits */
  async #remove(draft) {
    const place = resourcePath("scenes", draft.name);
    await this.#order(() => remove(place));
    await this.reopen("");
    const title = titleOf(draft.original);
    const undo = async () => {
      await this.#order(async () => {
        /** @type {SceneVersion[]} */
        const versions = await get(`${place}/versions`);
        const former = versions.find(({ removed }) => !removed)?.number ?? draft.base;
        /** @type {SavedScene} */
        const { scene } = await get(`${place}/versions/${former}`);
        const details = { author: this.author.value, note: `version ${former} again`, base: versions[0].number };
        const { number } = await put(place, sceneBody(scene, details));
        if (draft.base === former) draft.saved(number, scene);
      });
      await this.reopen(draft.name);
      this.messages.show(`Scene ${title} is back.`);
    };
    this.messages.show(`Scene ${title} is removed; its versions are kept.`, "note", {
      label: "Undo",
      order: undo,
    });
  }

  /** @template T @param {() => Promise<T>} order after which the draft knows what the service has */
  async #order(order) {
    this.isBusy = true;
    try {
      return await order();
    } finally {
      this.isBusy = false;
    }
  }
}

/** @param {string} id @param {number} length */
const textInput = (id, length) =>
  element("input", { type: "text", id: `scene-${id}`, maxlength: length, autocomplete: "off" });
