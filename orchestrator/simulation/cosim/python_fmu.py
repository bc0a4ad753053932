"""What keeps a third-party PythonFMU from being instantiated: its script runs in the Python of this program."""

import re
import sys

ABSENT = re.compile(r"No module named '([^']+)'")
WRITTEN_FOR = re.compile(r"needs Python [\d.]+")
OTHER_SYNTAX = ("SyntaxError", "IndentationError")


def instantiation_message(text: str) -> str:
    """Return the message of an FMU that cannot be instantiated, with what to do if it is a Python error."""
    here = f"Python {sys.version_info[0]}.{sys.version_info[1]}"
    text = " ".join(text.split())
    absent = ABSENT.search(text)
    if absent is not None:
        advice = f"its script imports {absent[1]}: install it in the Python of apa, {sys.executable}"
    elif any(word in text for word in OTHER_SYNTAX) or WRITTEN_FOR.search(text):
        advice = f"its script is not for {here}, in which apa runs: install apa-cosim in the Python it was made with"
    else:
        return text
    return f"{text}; {advice}"
