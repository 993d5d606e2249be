"""The page by the keyboard alone: the focus is led by Tab, and never lost."""

from typing import Any

from tests.system.operators import Operator
from tests.system.visits import Visit

MAX_TABS = 90  # from anywhere to anything: more is a trap
# What has the focus, in the words of a screen reader or of whoever looks at it; the page as a whole has none.
FOCUSED_SCRIPT = """() => {
  const one = document.activeElement;
  if (!one || one === document.body) return "";
  const text = one.matches("button, a, summary") ? one.textContent : "";
  const label = one.getAttribute("aria-label") ?? one.labels?.[0]?.textContent ?? text;
  return `${one.role ?? ""} ${one.id} ${label}`.replace(/\\s+/g, " ").trim();
}"""


class Keyboard:
    """Somebody who has no pointer, and counts what is pressed."""

    def __init__(self, visit: Visit) -> None:
        self.visit, self.page, self.presses = visit, visit.page, 0

    @property
    def focused(self) -> str:
        """What has the focus; empty when nothing has."""
        words: str = self.page.evaluate(FOCUSED_SCRIPT)
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
        self.go(words)
        self.press(key)
        self.keeps_focus(words)

    def tab(self, words: str) -> None:
        """Choose one of the page's tabs by the arrow keys."""
        self.go("tab tab-")
        for _ in range(MAX_TABS):
            if words in self.focused:
                return
            self.press("ArrowRight")
        raise AssertionError(f"the tab {words!r} is not reached; the focus is on {self.focused!r}")

    def keeps_focus(self, after: Any) -> None:
        self.visit.wait(lambda: self.focused != "", f"something has the focus after {after}")


def tell_by_keyboard(visit: Visit, operator: Operator) -> int:
    """Certify a way, edit it, save and certify that, run it and stop the arm; return how many keys were pressed."""
    keys, page = Keyboard(visit), visit.page
    keys.tab("Ways")
    keys.use("Certify way 1")
    visit.wait(lambda: page.get_by_role("button", name="Run way 1").is_visible())
    keys.keeps_focus("the plan has come")
    keys.tab("Ways")
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
    visit.wait(lambda: page.evaluate("document.querySelector('#arm progress')?.value < 1"))  # something waits
    keys.press("Space")
    page.wait_for_selector("#arm button.hold:not(:disabled)")
    visit.wait(lambda: "Keep pressed to start" in keys.focused, "the focus is where it was before the arm moved")
    return keys.presses
