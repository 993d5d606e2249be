"""The page by the keyboard alone: the focus is led by Tab, and never lost."""

from typing import Any

from tests.system.carriers import START, phase, until_box
from tests.system.operators import Operator
from tests.system.test_view import Visit

LOW = START[2] + 0.05  # [m]
MAX_TABS = 90  # from anywhere to anything: more is a trap
# What has the focus, in the words of a screen reader or of whoever looks at it; the page as a whole has none.
FOCUSED = """() => {
  const one = document.activeElement;
  if (!one || one === document.body) return "";
  const text = one.matches("button, a, summary") ? one.textContent : "";
  const label = one.getAttribute("aria-label") ?? one.labels?.[0]?.textContent ?? text;
  return `${one.role ?? ""} ${one.id} ${label}`.replace(/\\s+/g, " ").trim();
}"""


class Keyboard:
    """Somebody who has no pointer, and counts what is pressed, and what is done by it."""

    def __init__(self, visit: Visit) -> None:
        self.visit, self.page, self.presses, self.actions = visit, visit.page, 0, 0

    @property
    def focused(self) -> str:
        """What has the focus; empty when nothing has."""
        words: str = self.page.evaluate(FOCUSED)
        return words

    def press(self, key: str) -> None:
        self.presses += 1
        self.page.keyboard.press(key)

    def go(self, words: str) -> None:
        """Press Tab until something with these words has the focus."""
        for _ in range(MAX_TABS):
            if words in self.focused:
                return
            self.press("Tab")
        raise AssertionError(f"{words!r} is not reached; the focus is on {self.focused!r}")

    def use(self, words: str, key: str = "Enter") -> None:
        """Go to a button and press it; wait until something has the focus again, whatever became of the button."""
        self.actions += 1
        self.go(words)
        self.press(key)
        self.keeps_focus(words)

    def keeps_focus(self, after: Any) -> None:
        self.visit.wait(lambda: self.focused != "", f"something has the focus after {after}")

    def hold(self, name: str, until: str) -> None:
        """Keep a key pressed until the box, `at` [m], is where it should be."""
        self.presses += 1
        self.page.keyboard.down(name)
        until_box(self.visit, until)
        self.page.keyboard.up(name)

    def show(self) -> None:
        """Grasp the box, carry it and let it go."""
        self.actions += 1
        far = f"Math.hypot(at[0] - {START[0]}, at[1] - {START[1]}) > 0.1"
        self.press("Enter")
        phase(self.visit, "carrying")
        for key, there in (("PageUp", f"at[2] > {START[2] + 0.1}"), ("ArrowLeft", far), ("PageDown", f"at[2] < {LOW}")):
            self.hold(key, there)
        self.press("Enter")
        phase(self.visit, "ready")


def tell_by_keyboard(keys: Keyboard, operator: Operator) -> int:
    """Show a task, learn and edit it, certify that, run it and stop the arm; return the acts up to the first motion."""
    visit, page = keys.visit, keys.page
    keys.use("Show it here")
    phase(visit, "ready")
    visit.wait(lambda: "view" in keys.focused, "the keyboard carries")
    for _ in range(2):
        keys.show()
    keys.use("Finish")
    page.locator("#demonstration-session [data-learn]").wait_for()
    keys.use("Learn the ways")
    page.get_by_role("button", name="Edit way 1").wait_for()
    keys.use("Edit way 1")
    visit.wait(lambda: page.evaluate("teachpath.editor.draft !== null"))
    keys.go("edit-points")
    keys.press("Home")
    keys.press("ArrowDown")
    keys.go("z in millimetres")
    keys.press("ArrowUp")
    keys.use("Save version")
    page.wait_for_selector("#edit-certify:enabled:has-text('Certify version 2')")  # once its versions were read anew
    keys.use("Certify version 2")
    page.locator("#edit-run").wait_for()
    keys.use("Go to Run")
    visit.wait(lambda: page.evaluate("teachpath.state().plan?.path_version === 2"))
    acts = keys.actions + 3  # the point that was chosen and moved, and the start
    keys.go("Speed")
    keys.press("Home")
    for _ in range(10):
        keys.press("ArrowRight")

    def begun() -> bool:
        page.wait_for_selector("#arm button.hold:enabled")
        keys.go("Keep pressed to start")
        with operator.answer_to("executions") as answer:
            page.keyboard.down("Enter")
        page.keyboard.up("Enter")
        return bool(answer.value.ok)

    visit.wait(begun)
    page.wait_for_selector("#arm button.hold:disabled", state="attached")
    keys.keeps_focus("the arm has started")
    newest = operator.executions()[0].id
    visit.wait(lambda: operator.status().get("execution") == newest)
    keys.press("Space")
    page.wait_for_selector("#arm button.hold:not(:disabled)")
    visit.wait(lambda: "Keep pressed to start" in keys.focused, "the focus is where it was before the arm moved")
    return acts
