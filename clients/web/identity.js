// Who uses this page: signs people in and out, and says in every tab what they may not do in it.
import { get, post, remove } from "./api.js";
import { block, element, hint } from "./elements.js";

const CHECK_INTERVAL = 1000; // [ms] between two looks at who it is, while the connection is lost

export class IdentityControl {
  #checked = 0;
  #begin = () => {};

  /**
   * @param {Context} context
   * @param {{who: HTMLElement, signIn: HTMLElement}} parts the name in the header; where to sign in
   */
  constructor({ store, messages }, { who, signIn }) {
    this.store = store;
    this.messages = messages;
    this.who = who;
    this.place = signIn;
    this.name = element("input", { type: "text", id: "sign-in-name", required: "", autocomplete: "username" });
    const kind = { type: "password", id: "sign-in-password", required: "", autocomplete: "current-password" };
    this.password = element("input", kind);
    this.refusal = element("p", { class: "error", role: "alert" });
    const name = element("p", { class: "field" }, element("label", { for: "sign-in-name" }, "Name"), this.name);
    const label = element("label", { for: "sign-in-password" }, "Password");
    this.fields = [name, element("p", { class: "field" }, label, this.password)];
    this.button = element("button", { type: "submit", class: "primary" }, "Sign in");
    this.heading = element("h2", {}, "Sign in");
    this.hint = hint("");
    this.form = element(
      "form",
      {},
      this.heading,
      this.hint,
      ...this.fields,
      element("p", { class: "buttons" }, this.button),
      this.refusal,
    );
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.#attempt(() => (this.store.state.identity.provider ? goToProvider() : this.#signIn()));
    });
    this.who.addEventListener("click", (event) => {
      if (event.target instanceof HTMLButtonElement) messages.attempt(() => this.#signOut());
    });
  }

  get mayLook() {
    return this.store.state.identity.capabilities.includes("view");
  }

  /**
   * Ask who this is, and call `begin` once, as soon as somebody may look.
   * @param {() => void} begin
   */
  async whenSeeing(begin) {
    this.#begin = begin;
    const answer = takeProviderAnswer();
    await this.read();
    if (answer && !this.mayLook) await this.#attempt(async () => this.#show(await post("session/code", answer())));
    if (this.mayLook) this.#beginOnce();
  }

  #beginOnce() {
    const begin = this.#begin;
    this.#begin = () => {};
    begin();
  }

  // Ask who this is; without an answer it stays who it was.
  async read() {
    const identity = await get("identity").catch(() => null);
    if (identity) this.#show(identity);
  }

  // The same, where the connection is lost and perhaps the session with it; not too often.
  check() {
    if (Date.now() - this.#checked < CHECK_INTERVAL) return;
    this.#checked = Date.now();
    this.read();
  }

  /** @param {() => Promise<void>} act says in the form why it could not be done */
  async #attempt(act) {
    this.refusal.textContent = "";
    block(this.button, "Signing in …");
    try {
      await act();
    } catch (error) {
      this.refusal.textContent = error instanceof Error ? error.message : String(error);
      this.password.select();
    } finally {
      block(this.button, "");
    }
  }

  async #signIn() {
    const identity = await post("session", { name: this.name.value.trim(), password: this.password.value });
    this.messages.clear();
    this.#show(identity);
  }

  async #signOut() {
    await remove("session");
    await this.read();
  }

  /** @param {Identity} identity who it is, perhaps as before: what is being typed stays */
  #show(identity) {
    this.store.set({ identity });
    const isMissing = !this.mayLook;
    document.documentElement.dataset.signedIn = String(!isMissing);
    this.place.hidden = !isMissing;
    this.who.hidden = identity.mode === "none" || isMissing;
    const isProxied = identity.mode === "proxy"; // people sign in and out there
    const hasPasswords = !isProxied && identity.provider === "";
    this.who.replaceChildren(identity.name, ...(isProxied ? [] : [element("button", { type: "button" }, "Sign out")]));
    if (isProxied) this.who.title = groupsSentence(identity);
    this.heading.textContent = isProxied ? "No role here" : "Sign in";
    this.hint.textContent = isProxied ? noRoleSentence(identity) : SIGN_IN_SENTENCE;
    for (const field of this.fields) field.hidden = !hasPasswords;
    for (const input of [this.name, this.password]) input.disabled = !hasPasswords;
    this.button.hidden = isProxied;
    this.button.textContent = identity.provider ? `Sign in with ${identity.provider}` : "Sign in";
    if (isMissing && !this.form.isConnected) {
      this.place.append(this.form);
      this.name.focus();
    } else if (!isMissing) {
      this.form.remove();
      this.password.value = "";
      this.#beginOnce();
    }
  }
}

// Leave for the provider at which people sign in; it sends the browser back to this page.
async function goToProvider() {
  const { address } = await post("session/authorization", { path: location.pathname });
  location.assign(address);
}

/**
 * What the provider has sent the browser back with, taken out of the page's address, which is kept and shown.
 * @returns {(() => {code: string, state: string, iss: string}) | null} throws where the provider has refused
 */
function takeProviderAnswer() {
  const given = new URLSearchParams(location.search);
  const [code, state, iss, error] = ["code", "state", "iss", "error"].map((name) => given.get(name) ?? "");
  if (!state || !(code || error)) return null;
  history.replaceState(null, "", location.pathname + location.hash);
  return () => {
    // Anybody can send somebody to this page with an error of his own: it may be a word of OAuth, and no sentence.
    const word = /^[a-z_]{1,40}$/.test(error) ? error : "error";
    if (!code) throw new Error(`The provider has signed nobody in (${word}). Sign in again.`);
    return { code, state, iss };
  };
}

const SIGN_IN_SENTENCE = "This station asks who uses it. The arm is stopped by everybody, signed in or not.";

/** @param {Identity} identity */
function groupsSentence({ groups }) {
  return groups.length ? `The proxy says that you are in: ${groups.join(", ")}.` : "The proxy names no group of yours.";
}

/** @param {Identity} identity of somebody whom the proxy has let through */
function noRoleSentence(identity) {
  const who = identity.name ? `The proxy says that you are ${identity.name}.` : "The proxy does not say who you are.";
  const way = "Whoever administers the station gives a role to one of your groups. Stop works all the same.";
  return `${who} ${groupsSentence(identity)} No role at this station follows from that. ${way}`;
}

/** @type {Record<string, string>} */
const WORK = {
  demonstrate: "show demonstrations",
  teach: "learn, edit and plan",
  operate: "move the arm",
};

/**
 * What somebody may not do that a tab is for, as a sentence; empty when all of it is possible.
 * @param {Identity} identity
 * @param {Identity["capabilities"]} needed
 */
export function missingSentence(identity, needed) {
  const missing = needed.filter((one) => !identity.capabilities.includes(one));
  if (!missing.length) return "";
  const work = missing.map((one) => WORK[one]).join(", or ");
  const roles = missing.map((one) => `“${one}”`).join(" and ");
  const who = identity.name || "Whoever comes through the proxy";
  const groups = identity.mode === "proxy" ? ` ${groupsSentence(identity)}` : "";
  const way = "Whoever administers the station gives it.";
  return `${who} may look at this, but not ${work}: that needs the role ${roles}.${groups} ${way}`;
}
