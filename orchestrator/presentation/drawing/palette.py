"""What each colour means, the same in pages and pictures.

Blue is the car and what it does, violet (dashed) is requested of it or planned. The states of a chart
have eight hues that nothing else has; green, red, amber and grey say that something is good, wrong, urgent
or idle. On a page of several runs a colour is a run. Text on a hue has a contrast of 4.5 or more.
"""

import json

HUE_COUNT = 8
LIGHT = {
    **{"good": "#1c7d43", "bad": "#ca3238", "warn": "#a35f00", "idle": "#676f77", "stop": "#c2453a"},
    **{"s0": "#06798e", "s1": "#c2255c", "s2": "#087c5b", "s3": "#9c36b5"},
    **{"s4": "#8b6900", "s5": "#587400", "s6": "#8a5740", "s7": "#54678a"},
    **{"run-a": "#1e6bd9", "run-b": "#bf4706", "run-c": "#0b7a75", "run-d": "#a61e7a"},
    **{"run-e": "#6b6b00", "run-f": "#5c4033", "asked": "#6d5bd0"},
}
DARK = {
    **{"good": "#46c07a", "bad": "#ff6b6b", "warn": "#f5b041", "idle": "#8391a1", "stop": "#e06a5f"},
    **{"s0": "#4fc6dd", "s1": "#ff7aa8", "s2": "#3ecf9f", "s3": "#d28bec"},
    **{"s4": "#e3bd3a", "s5": "#b2cc4a", "s6": "#d9a184", "s7": "#9fb3d6"},
    **{"run-a": "#5c9dff", "run-b": "#ff9248", "run-c": "#3fd0c6", "run-d": "#f27fd0"},
    **{"run-e": "#d5d84f", "run-f": "#d3a58b", "asked": "#a393ff"},
}
STATES = {
    **dict.fromkeys(("STANDBY", "OFF", "NONE", "PARK", "NEUTRAL"), "idle"),
    **dict.fromkeys(("PARKED", "PARKING_FINISH"), "good"),
    **dict.fromkeys(("FAILED", "FAIL"), "bad"),
    **dict.fromkeys(("TAKEOVER", "TAKE_OVER", "SLOW_DOWN"), "warn"),
    **{"STOP": "stop", "PATH_TRACKING": "s0", "TO_Q2": "s1", "TO_Q1": "s2", "TO_Q4": "s3", "PRE_STEER": "s4"},
    **{"TO_Q3": "s5", "STRAIGHTEN": "s6"},
}
"""Name of a state -> its colour; any other state has the hue of its value."""
RUNS = tuple(name for name in LIGHT if name.startswith("run-"))


def role(state: str, value: float) -> str:
    """Return the name of the colour of a state."""
    return STATES.get(state) or f"s{round(value) % HUE_COUNT}"


def css(colours: dict[str, str]) -> str:
    """Return colours as the custom properties of a style sheet."""
    return " ".join(f"--{name}: {value};" for name, value in colours.items())


def script() -> str:
    """Return the colours of the states for the scripts of a page."""
    return f"const NAMED = {json.dumps(STATES)};\n"
