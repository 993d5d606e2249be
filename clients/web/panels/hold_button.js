// A button that must be held for a while, by pointer or key, before it does anything; letting go takes it back.
const HOLD_TIME = 800; // [ms]

/**
 * @template T
 * @param {HTMLButtonElement} button
 * @param {() => T} onPress what is looked at when it is pressed
 * @param {(pressed: T) => void} onHeld told what was looked at then
 */
export function bindHold(button, onPress, onHeld) {
  let timer = 0;
  const cancel = () => {
    clearTimeout(timer);
    timer = 0;
    button.classList.remove("holding");
  };
  /** @param {Event} event */
  const begin = (event) => {
    if (button.disabled || timer) return;
    event.preventDefault();
    button.classList.add("holding");
    const pressed = onPress();
    timer = setTimeout(() => {
      cancel();
      onHeld(pressed);
    }, HOLD_TIME);
  };
  button.addEventListener("pointerdown", begin);
  button.addEventListener("contextmenu", (event) => event.preventDefault()); // a finger that stays asks for it
  button.addEventListener("keydown", (event) => {
    if (!event.repeat && ["Enter", " "].includes(event.key)) begin(event);
  });
  for (const name of ["pointerup", "pointerleave", "pointercancel", "keyup", "blur"]) {
    button.addEventListener(name, cancel);
  }
}
