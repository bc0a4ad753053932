"""Somebody at the keyboard of the page: looks at prompt and speed, presses real keys."""

from collections.abc import Callable
from typing import Any, NamedTuple

LOOK = """() => {
  const { drive } = window.live, last = (name) => drive.history.last(name);
  return { prompt: drive.state("controller.prompt"), phase: drive.state("controller.phase"),
    speed: Math.abs(last("vehicle.speed")), advised: last("controller.advised_speed"),
    shifts: last("controller.shifts"), gear: drive.state("vehicle.gear"), t: drive.t, over: drive.isOver };
}"""
NEAR, MOST_LOOKS = 0.04, 20000


class Seen(NamedTuple):
    """What a person sees."""

    prompt: str
    phase: str
    speed: float
    advised: float
    shifts: float
    gear: str
    t: float
    over: bool


Will = Callable[[Seen], tuple[str, float]]
"""What a person wants: lever (R, D or nothing) and speed [m/s]."""


def obeys(seen: Seen) -> tuple[str, float]:
    """Return what one wants who does as asked."""
    if seen.prompt == "STOP":
        return "", 0.0
    speed = min(0.35, seen.advised) if seen.advised > 0.0 else 0.35
    return {"REVERSE": "R", "FORWARD": "D"}.get(seen.prompt, ""), speed if seen.prompt != "NONE" else 0.0


def hurries_once(seen: Seen) -> tuple[str, float]:
    """Return what one wants who is deaf to slow down until the first stop."""
    if seen.shifts <= 1.0 and seen.phase in ("PRE_STEER", "PATH_TRACKING"):
        return ("R", 1.6) if seen.prompt in ("REVERSE", "SLOW_DOWN") else ("", 0.0)
    return obeys(seen)


def never_obeys(seen: Seen) -> tuple[str, float]:
    """Return what one wants who reverses on and on."""
    return "R", 1.2 if seen.t > 1.5 else 0.0


def drive(page: Any, will: Will, pace: int = 1) -> dict[str, Any]:
    """Drive by ``will`` to the end; return the verdict of the page."""
    page.evaluate(f"() => {{ window.live.drive.pace = {pace}; }}")
    page.click("#person + *, label:has(#person)")
    page.evaluate("() => document.activeElement.blur()")
    page.keyboard.press(" ")
    held: set[str] = set()
    for _ in range(MOST_LOOKS):
        seen = Seen(**page.evaluate(LOOK))
        if seen.over:
            break
        lever, speed = will(seen)
        if lever and seen.gear != {"R": "REVERSE", "D": "DRIVE"}[lever] and seen.speed < 0.02:
            page.keyboard.press(lever.lower())
        braking = speed == 0.0 or seen.speed > speed + NEAR
        wanted = {"s"} if braking else {"w"} if seen.speed < speed else set()
        for key in held - wanted:
            page.keyboard.up(key)
        for key in wanted - held:
            page.keyboard.down(key)
        held = wanted
    return page.evaluate("() => ({ ...window.live.mine, byHand: window.live.drive.byHand })")
