"""JUnit XML, as CI servers read it, from the checks of runs."""

import xml.etree.ElementTree as ElementTree
from collections.abc import Mapping
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

from fmus.files import whole
from orchestrator.evaluation.verdict.judge import Check
from orchestrator.evaluation.verdict.limit_text import sentence

UNPRINTABLE = {code: "?" for code in range(32) if chr(code) not in "\t\n\r"}
"""Control characters, which XML cannot hold."""


class Case(NamedTuple):
    """One test case."""

    name: str
    passed: bool
    text: str
    """What was found; the message of a failure."""
    skipped: bool = False
    """Beyond its limit, but not required."""


class Suite(NamedTuple):
    """The cases of one run."""

    name: str
    cases: list[Case]
    time: float
    """Time it took [s]."""
    error: str = ""
    """Why the run could not be judged at all."""
    properties: Mapping[str, str] = MappingProxyType({})
    """What else is to be known of it."""


def cases_of(checks: list[Check]) -> list[Case]:
    """Return one case for each check; one that is missed but not required, or not judged, is skipped, not failed."""
    found = []
    for check in checks:
        skipped = not check.evaluated or not (check.passed or check.required)
        found.append(Case(f"{check.id} ({check.source})", check.passed, sentence(check), skipped))
    return found


def number_duplicates(cases: list[Case]) -> list[Case]:
    """Return the cases, numbered where a name comes again: CI servers take equal names for one test."""
    names = [case.name for case in cases]
    counts = [names[:at].count(name) for at, name in enumerate(names)]
    return [
        case._replace(name=f"{case.name} #{count + 1}") if count else case
        for case, count in zip(cases, counts, strict=True)
    ]


def write_junit(path: Path, suites: list[Suite], about: Mapping[str, str] = MappingProxyType({})) -> None:
    """Write the suites to ``path``; ``about`` says what was tested, when and how."""
    root = ElementTree.Element("testsuites", name="apa")
    totals = [0, 0, 0, 0]
    for suite in suites:
        counts = [
            len(suite.cases) + (1 if suite.error else 0),
            sum(not case.passed and not case.skipped for case in suite.cases),
            1 if suite.error else 0,
            sum(case.skipped for case in suite.cases),
        ]
        totals = [total + count for total, count in zip(totals, counts, strict=True)]
        attributes = {"name": _text(suite.name), "time": f"{suite.time:.3f}", **_counts(counts)}
        node = ElementTree.SubElement(root, "testsuite", attributes)
        if "when" in about:
            node.set("timestamp", about["when"])
        if about or suite.properties:
            properties = ElementTree.SubElement(node, "properties")
            common = {key: text for key, text in about.items() if key != "warning"}
            for key, text in {**common, **suite.properties}.items():
                ElementTree.SubElement(properties, "property", name=_text(key), value=_text(text))
        if suite.error:
            _case(node, suite.name, "run", "error", suite.error)
        for case in number_duplicates(suite.cases):
            kind = "" if case.passed else "skipped" if case.skipped else "failure"
            _case(node, suite.name, case.name, kind, case.text)
    root.attrib.update(_counts(totals))
    ElementTree.indent(root)
    with whole(path) as part:
        ElementTree.ElementTree(root).write(part, encoding="utf-8", xml_declaration=True)


def _counts(counts: list[int]) -> dict[str, str]:
    return {key: str(count) for key, count in zip(("tests", "failures", "errors", "skipped"), counts, strict=True)}


def _case(suite: ElementTree.Element, classname: str, name: str, kind: str, text: str) -> None:
    case = ElementTree.SubElement(suite, "testcase", classname=_text(classname), name=_text(name))
    if kind:
        ElementTree.SubElement(case, kind, message=_text(text))
    else:
        ElementTree.SubElement(case, "system-out").text = _text(text)


def _text(text: str) -> str:
    return text.translate(UNPRINTABLE)
