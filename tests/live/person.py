"""Somebody at the keyboard of the page: looks at prompt and speed, presses real keys."""

import time
from collections.abc import Callable
from typing import Any, NamedTuple

LOOK = """() => {
  const { drive } = window.live, last = (name) => drive.history.last(name);
  return { prompt: drive.state("controller.prompt"), phase: drive.state("controller.phase"),
    speed: Math.abs(last("vehicle.speed")), advised: last("controller.advised_speed"),
    manoeuvres: last("controller.manoeuvres"), gear: drive.state("vehicle.gear"), t: drive.t, over: drive.isOver };
}"""
LOOK_EVERY = 100
"""Of the drive's time [ms]."""
NEAR, MOST_LOOKS = 0.04, 2000


class Seen(NamedTuple):
    """What a person sees."""

    prompt: str
    phase: str
    speed: float
    advised: float
    manoeuvres: float
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
    if seen.manoeuvres <= 1.0 and seen.phase in ("PRE_STEER", "PATH_TRACKING"):
        return ("R", 1.6) if seen.prompt in ("REVERSE", "SLOW_DOWN") else ("", 0.0)
    return obeys(seen)


def never_obeys(seen: Seen) -> tuple[str, float]:
    """Return what one wants who reverses on and on."""
    return "R", 1.2 if seen.t > 1.5 else 0.0


def standing_clock(page: Any) -> None:
    """Let the page's clock stand; ``page.clock.run_for`` moves it on."""
    page.clock.install()
    page.clock.pause_at(time.time() + 1.0)


def drive(page: Any, will: Will, pace: int = 4) -> dict[str, Any]:
    """Drive by ``will`` to the end, a look each tenth of a second of the drive; return the verdict of the page.

    The page's clock stands while nobody looks: what is driven does not depend on how busy the machine is.
    """
    standing_clock(page)
    page.click(f'label:has([name="pace"][value="{pace}"])')
    page.click("#person + *, label:has(#person)")
    page.keyboard.press(" ")
    held: set[str] = set()
    for _ in range(MOST_LOOKS):
        page.clock.run_for(LOOK_EVERY / pace)
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
    page.clock.run_for(1000)
    return page.evaluate("() => ({ ...window.live.mine, byHand: window.live.drive.byHand })")
