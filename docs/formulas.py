"""Hook of mkdocs: formulas that stand as plain text in an indented block are set as formulas, in MathML.

The text stays what one reads in the repository: ``phi = atan( L cos^3 h [ k1 (y_r - y) - k2 tan h ] )``. Factors stand
side by side, ``/`` divides all factors before it by the one after it, a name ends in its index (``k1``, ``h_e``).
A block that does not read so stays as it is.
"""

import html
import re
from typing import Any

BLOCK = re.compile(r"(?<=\n\n)((?:    \S[^\n]*\n)+)(?=\n)")
TOKEN = re.compile(r"\s*(?:(\d+(?:\.\d+)?)|([A-Za-z]+\d*(?:_\w+)?'*(?:\+(?=[\s)=]|$))?)|(<=|>=|[-+=/^()\[\]|,]))")
FUNCTIONS = ("atan2", "atan", "tan", "cos", "sin", "sqrt")
GREEK = {"phi": "\u03c6", "rho": "\u03c1", "kappa": "\u03ba", "delta": "\u03b4", "psi": "\u03c8"}
GAP = '<mspace width="2.5em"/>'
SIGNS = {"<=": "≤", ">=": "≥", "-": "\u2212"}
CLOSING = {"(": ")", "[": "]", "|": "|"}
PARTS = re.compile(r"([A-Za-z]+?)(\d*)(?:_(\w+?))?('*)(\+?)$")


def on_page_markdown(markdown: str, **_: Any) -> str:
    """Return the page with its formulas set."""
    return BLOCK.sub(lambda match: formulas(match[1]) or match[1], markdown)


def formulas(block: str) -> str:
    """Return the lines of a block as MathML; empty if they are no formulas."""
    try:
        lines = [GAP.join(map(mathml, re.split(r" {3,}", line.strip()))) for line in _lines(block)]
    except ValueError:
        return ""
    return "".join(f'<div class="formula"><math display="block">{line}</math></div>\n' for line in lines)


def _lines(block: str) -> list[str]:
    if not all("=" in line for line in block.splitlines()):
        raise ValueError("no formula")
    return block.splitlines()


def mathml(text: str) -> str:
    """Return a formula as MathML. Raises ``ValueError`` if it does not read as one."""
    reader = _Reader(text)
    found = reader.relation()
    if reader.kind != "end":
        raise ValueError(f"{text}: {reader.text} is not expected")
    return found


class _Reader:
    """Reads a formula from left to right."""

    def __init__(self, text: str) -> None:
        self.rest = text
        self.next()

    def next(self) -> str:
        """Go on to the next token; return the one before."""
        before = getattr(self, "text", "")
        match = TOKEN.match(self.rest)
        if self.rest.strip() and match is None:
            raise ValueError(self.rest)
        self.kind, self.text = "end", ""
        if match is not None:
            self.kind = ("number", "name", "sign")[(match.lastindex or 1) - 1]
            self.text = match[match.lastindex or 1]
            self.rest = self.rest[match.end() :]
        return before

    def relation(self) -> str:
        """Sums with signs of relation between them."""
        found = self.sum()
        while self.text in ("=", "<=", ">="):
            found += _sign(self.next()) + self.sum()
        return found

    def sum(self) -> str:
        """Terms with plus and minus."""
        found = _sign(self.next()) if self.text in ("-", "+") else ""
        found += self.term()
        while self.text in ("-", "+"):
            found += _sign(self.next()) + self.term()
        return found

    def term(self) -> str:
        """Factors side by side, and what divides them."""
        factors = [self.factor()]
        while self.text == "/" or self.kind in ("number", "name") or self.text in ("(", "["):
            if self.text == "/":
                self.next()
                above = factors[0] if len(factors) == 1 else "".join(factors)
                factors = [f"<mfrac><mrow>{_bare(above)}</mrow><mrow>{_bare(self.factor())}</mrow></mfrac>"]
            else:
                factors.append(self.factor())
        return '<mspace width="0.17em"/>'.join(factors)

    def factor(self) -> str:
        """A number, a name, a function of a factor, or something in brackets; perhaps to a power."""
        if self.kind == "name" and self.text in FUNCTIONS:
            return self.function()
        if self.kind == "number":
            found = f"<mn>{self.next()}</mn>"
        elif self.kind == "name":
            found = _name(self.next())
        elif self.text in CLOSING:
            found = self.group()
        else:
            raise ValueError(f"{self.text} is not expected")
        return self.power(found)

    def power(self, base: str) -> str:
        """``extends`` to the power that follows, if one does."""
        if self.text != "^":
            return base
        self.next()
        return f"<msup><mrow>{base}</mrow>{self.factor()}</msup>"

    def function(self) -> str:
        """A function with its argument."""
        name = self.next()
        if name == "sqrt":
            return f"<msqrt>{_bare(self.group())}</msqrt>"
        shown = self.power(f"<mi>{name}</mi>") if self.text == "^" else f"<mi>{name}</mi>"
        argument = self.group() if self.text == "(" else f'<mspace width="0.17em"/>{self.factor()}'
        return f"<mrow>{shown}{argument}</mrow>"

    def group(self) -> str:
        """What stands in brackets, with commas perhaps."""
        opening = self.next()
        closing = CLOSING[opening]
        parts = [self.sum()]
        while self.text == ",":
            self.next()
            parts.append(self.sum())
        if self.text != closing:
            raise ValueError(f"{closing} is missing")
        self.next()
        return f"<mrow><mo>{opening}</mo>{'<mo>,</mo>'.join(parts)}<mo>{closing}</mo></mrow>"


def _sign(text: str) -> str:
    return f"<mo>{html.escape(SIGNS.get(text, text))}</mo>"


def _bare(text: str) -> str:
    """Return a fraction's part without the brackets that the bar makes needless."""
    start, end = "<mrow><mo>(</mo>", "<mo>)</mo></mrow>"
    inside = text[len(start) : -len(end)]
    whole = text.startswith(start) and text.endswith(end) and inside.count("<mo>(</mo>") == inside.count("<mo>)</mo>")
    return inside if whole and _closes_last(inside) else text


def _closes_last(inside: str) -> bool:
    """Return whether no bracket inside closes the first one early."""
    depth = 0
    for mark in re.findall(r"<mo>([()])</mo>", inside):
        depth += 1 if mark == "(" else -1
        if depth < 0:
            return False
    return True


def _name(text: str) -> str:
    """Return a name with its index, its primes and its plus."""
    match = PARTS.match(text)
    if match is None:
        raise ValueError(text)
    word, digits, index, primes, plus = match.groups()
    before = ""
    if re.fullmatch("d[A-Za-z]", word) and not index:
        before, word = "<mi>d</mi>", word[1]
    elif re.fullmatch("D[xy]", word):
        word, index = "D", word[1]
    found = f"<mi>{GREEK.get(word, word)}</mi>"
    if digits or index:
        below = digits or index
        kind = "mn" if below.isdigit() else "mi"
        found = f"<msub>{found}<{kind}>{GREEK.get(below, below)}</{kind}></msub>"
    above = "\u2032" * len(primes) + plus
    found = f"<msup>{found}<mo>{above}</mo></msup>" if above else found
    return f"<mrow>{before}{found}</mrow>" if before else found
