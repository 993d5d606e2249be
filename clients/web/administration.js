// Who may use the station: people and tokens, listed, made and taken back by whoever administers it, in a popover.
import { get, post, put, remove, resourcePath } from "./api.js";
import { closestData, element, hint, option } from "./elements.js";
import { isName, nameRefusal } from "./names.js";
import { patchChildren } from "./patch_children.js";
import { formatMoment, pluralize } from "./texts.js";

/** @type {Identity["capabilities"]} */
const ROLES = ["view", "demonstrate", "teach", "operate", "administer"];
const ABOUT_PEOPLE = "They sign in on this page. With another password, or removed, they are signed out everywhere.";
/** @param {string} provider */
const aboutProvider = (provider) =>
  `They sign in at ${provider} and are added there; its groups say what they may do here. Who is removed here is signed out ` +
  `everywhere, and may come again as long as ${provider} has a group for it.`;
const ABOUT_TOKENS = "Programs send one with every request. What a revoked one has opened is closed within a second.";
const SHOWN_ONCE = "Copy it now: the station keeps a hash of it, and never tells it again.";

/**
 * @param {HTMLElement} place a popover that `button` opens
 * @param {HTMLElement} button shown to whoever administers the station
 * @param {Context} context
 */
export function administration(place, button, { store }) {
  const [people, tokens] = ["people", "tokens"].map((label) => element("ul", { class: "access", "aria-label": label }));
  const refusal = element("p", { class: "error", role: "alert" });
  const made = element("div", { role: "status" });
  const days = element("input", { type: "number", id: "token-days", min: 1, max: 3650, value: 90, required: "" });
  const person = new AccessForm("person", "Add the person", ["Password", passwordInput("person-password")]);
  const token = new AccessForm("token", "Make the token", ["Days", days]);
  const other = passwordInput("other-password");
  // Whose it is, for whatever keeps passwords.
  const otherName = element("input", { type: "text", autocomplete: "username", hidden: "", readonly: "" });
  const otherLabel = element("label", { for: other.id });
  const otherForm = element(
    "form",
    { hidden: "" },
    otherName,
    element("p", { class: "field" }, otherLabel, other),
    element("p", { class: "buttons" }, element("button", { type: "submit" }, "Set the password")),
  );
  const aboutPeople = hint(ABOUT_PEOPLE);
  place.append(element("h2", {}, "People"), aboutPeople, people, otherForm, person.form);
  place.append(element("h2", {}, "Tokens"), hint(ABOUT_TOKENS), tokens, made, token.form, refusal);
  let chosen = ""; // whose password is changed

  async function read() {
    const [allPeople, allTokens] = await Promise.all([get("people"), get("tokens")]);
    const { provider } = store.state.identity;
    const nobody = element("li", {}, hint("Nobody has signed in yet."));
    patchChildren(
      people,
      allPeople.length ? allPeople.map((/** @type {ListedPerson} */ one) => personRow(one, !provider)) : nobody,
    );
    patchChildren(tokens, allTokens.length ? allTokens.map(tokenRow) : element("li", {}, hint("No tokens yet.")));
  }

  /** Give an order and read what has come of it; a refusal stands below. @param {() => Promise<unknown>} order */
  async function attempt(order) {
    refusal.textContent = "";
    try {
      await order();
      await read();
    } catch (error) {
      refusal.textContent = error instanceof Error ? error.message : String(error);
      refusal.scrollIntoView({ block: "nearest" });
    }
  }

  /** @param {string} name of whom another password is asked for; empty: of nobody */
  function choose(name) {
    chosen = name;
    otherForm.hidden = !name;
    otherName.value = name;
    otherLabel.textContent = `New password of ${name}`;
    other.value = "";
    if (name) other.focus();
  }

  // No secret stays in the page longer than it is looked at.
  function forget() {
    made.replaceChildren();
    person.last.value = "";
    choose("");
  }

  store.subscribe(({ identity }, changed) => {
    if (!changed.has("identity")) return;
    button.hidden = !["token", "oidc"].includes(identity.mode) || !identity.capabilities.includes("administer");
    person.form.hidden = identity.provider !== "";
    aboutPeople.textContent = identity.provider ? aboutProvider(identity.provider) : ABOUT_PEOPLE;
    if (button.hidden && place.matches(":popover-open")) place.hidePopover();
  });
  // The toggle comes only after a while, when a person may have typed already.
  place.addEventListener("beforetoggle", (event) => {
    forget();
    if (event instanceof ToggleEvent && event.newState === "open") attempt(async () => {});
  });
  person.onSubmit(() =>
    attempt(async () => {
      await post("people", { ...person.wanted, password: person.last.value });
      person.clear();
      person.last.value = "";
    }),
  );
  token.onSubmit(() =>
    attempt(async () => {
      const answer = await post("tokens", { ...token.wanted, days: days.valueAsNumber });
      token.clear();
      if (!place.matches(":popover-open")) return; // it was left meanwhile: nobody has seen the token
      made.replaceChildren(
        element("p", {}, `Token ${answer.name}: `, element("code", {}, answer.token)),
        hint(SHOWN_ONCE),
      );
    }),
  );
  otherForm.addEventListener("submit", (event) => {
    event.preventDefault();
    attempt(async () => {
      await put(resourcePath("people", chosen, "password"), { password: other.value });
      choose("");
    });
  });
  place.addEventListener("click", (event) => {
    const { removePerson, newPassword, revokeToken } = closestData(event);
    if (newPassword) choose(newPassword);
    if (removePerson && confirm(`Remove ${removePerson}? Every session of ${removePerson} ends.`))
      attempt(async () => {
        if (removePerson === chosen) choose("");
        await remove(resourcePath("people", removePerson));
      });
    if (revokeToken && confirm(`Revoke the token ${revokeToken}? Programs that use it are refused from then on.`))
      attempt(() => remove(resourcePath("tokens", revokeToken)));
  });
}

/** A form of a name, a role and one thing more. */
class AccessForm {
  /**
   * @param {"person" | "token"} kind
   * @param {string} order what its button says
   * @param {[string, HTMLInputElement]} further label and input of the one thing more
   */
  constructor(kind, order, [label, last]) {
    this.last = last;
    this.name = element("input", {
      type: "text",
      id: `${kind}-name`,
      required: "",
      autocomplete: kind === "person" ? "username" : "off",
    });
    this.role = element(
      "select",
      { id: `${kind}-role` },
      ROLES.map((role) => option(role)),
    );
    this.form = element(
      "form",
      {},
      element("p", { class: "field" }, element("label", { for: `${kind}-name` }, `Name of the ${kind}`), this.name),
      element("p", { class: "field" }, element("label", { for: `${kind}-role` }, `Role of the ${kind}`), this.role),
      element("p", { class: "field" }, element("label", { for: last.id }, label), last),
      element("p", { class: "buttons" }, element("button", { type: "submit" }, order)),
    );
    this.name.addEventListener("input", () => {
      const wanted = this.name.value.trim();
      this.name.setCustomValidity(wanted === "" || isName(wanted) ? "" : nameRefusal(kind, wanted));
    });
  }

  get wanted() {
    return { name: this.name.value.trim(), roles: [this.role.value] };
  }

  clear() {
    this.name.value = "";
  }

  /** @param {() => void} order */
  onSubmit(order) {
    this.form.addEventListener("submit", (event) => {
      event.preventDefault();
      order();
    });
  }
}

/** @param {string} id */
function passwordInput(id) {
  return element("input", { type: "password", id, required: "", minlength: 10, autocomplete: "new-password" });
}

/** @param {ListedPerson} person @param {boolean} hasPassword here, not at a provider */
function personRow({ name, roles, sessions, used_ns }, hasPassword) {
  const use = sessions
    ? `${sessions} ${pluralize(sessions, "session")}, used ${formatMoment(used_ns)}`
    : "not signed in";
  return element(
    "li",
    { "data-key": name },
    element("span", {}, element("b", {}, name), ` ${roles.join(", ")}; ${use}`),
    hasPassword && element("button", { type: "button", "data-new-password": name }, "New password"),
    element("button", { type: "button", "data-remove-person": name }, "Remove"),
  );
}

/** @param {ListedToken} token */
function tokenRow({ name, roles, created_ns, expires_ns, used_ns, revoked_ns }) {
  const isExpired = expires_ns / 1e6 < Date.now();
  const state = revoked_ns ? "revoked" : isExpired ? "expired" : `until ${formatMoment(expires_ns)}`;
  const holds = !revoked_ns && !isExpired;
  return element(
    "li",
    { "data-key": `${name} ${created_ns}` },
    element("span", {}, element("b", {}, name), ` ${roles.join(", ")}; ${state}; used ${formatMoment(used_ns)}`),
    holds && element("button", { type: "button", "data-revoke-token": name }, "Revoke"),
  );
}
