"""A program's way through the levels as JUnit's XML: a test for each level and robot."""

from __future__ import annotations

from xml.etree import ElementTree

from rttrr_pin.conformance.levels import LEVELS
from rttrr_pin.conformance.results import Conformance, LevelResult
from rttrr_pin.reporting.output import shown

TAGS = {"fail": "failure", "error": "error", "not offered": "skipped"}
"""What a test has in it that was not passed."""


def junit(result: Conformance) -> str:
    """A document that CI servers show."""
    suites = ElementTree.Element("testsuites")
    seconds = f"{result.seconds:.3f}"
    suite = ElementTree.SubElement(suites, "testsuite", name=f"rttrr-pin conform {result.subject}", time=seconds)
    sentences = {level.id: level.sentence for level in LEVELS}
    for own in result.results:
        test = ElementTree.SubElement(suite, "testcase", classname=own.robot, name=own.id, time="0")
        text = f"{sentences[own.level]}\n{own.summary()}"
        if own.passed:
            ElementTree.SubElement(test, "system-out").text = text
        else:
            _told(test, own, text)
    suite.set("tests", str(len(result.results)))
    for attribute, tag in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
        suite.set(attribute, str(len(suite.findall(f"testcase/{tag}"))))
    ElementTree.indent(suites)
    return shown(ElementTree.tostring(suites, encoding="unicode", xml_declaration=True)) + "\n"


def _told(test: ElementTree.Element, own: LevelResult, text: str) -> None:
    """Why it was not passed; a skipped test has no type."""
    message = own.cause or own.message or own.summary()
    attributes = {"message": message} | ({} if own.outcome == "not offered" else {"type": own.level})
    ElementTree.SubElement(test, TAGS[own.outcome], attributes).text = text
