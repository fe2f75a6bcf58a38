"""An audit as a page: how much of a publication is right, then the errata with their evidence."""

from __future__ import annotations

from collections.abc import Iterator

from rttrr_pin.auditing.errata import errata_document
from rttrr_pin.auditing.results import AuditResult, Verdict
from rttrr_pin.derivation.writers import document as doc
from rttrr_pin.derivation.writers.html import part
from rttrr_pin.reporting.html import Block, Figures, Page, Written, bars, robot_drawing


def audit_page(result: AuditResult) -> Page:
    """What the page says."""
    document, totals = errata_document(result), result.totals
    opening, *sections = _sections(document.blocks)
    unread = result.count(Verdict.UNPARSED) + result.count(Verdict.UNDECLARED)
    return Page(
        title=document.title,
        compared=result.publication.source,
        verdict="PASS" if result.passed else "FAIL",
        tone="agrees" if result.passed else "unexplained" if result.count(Verdict.DIFFERS) else "explained",
        sentence=result.summary(),
        facts=(
            ("components", f"{totals.components}"),
            ("right as printed", f"{result.count(Verdict.MATCH)}"),
            ("findings", f"{totals.findings}"),
            ("terms of the wrong dimension", f"{totals.dimensionally_wrong}"),
            *([("not read", f"{unread}")] if unread else []),
        ),
        blocks=(*_pictures(result), opening, *sections),
        command="audit",
    )


def _pictures(result: AuditResult) -> Iterator[Figures]:
    """What kinds of errors there are, and the robot."""
    kinds = {str(kind): float(number) for kind, number in result.totals.kinds.items() if number}
    model = result.publication.robot.model
    robot = robot_drawing(model, title=f"{model.name}, all coordinates zero")
    charts = [bars("kinds", "Findings by kind", kinds, "findings")] if kinds else []
    yield Figures("Where the errors are", (*charts, robot)) if kinds else Figures("The robot", (robot,))


def _sections(blocks: tuple[doc.Block, ...]) -> Iterator[Block]:
    """The blocks in front of the first heading, then those of each."""
    title, own = "", list[doc.Block]()
    for block in (*blocks, doc.Heading("")):
        if isinstance(block, doc.Heading) and block.level == 1:
            yield Written(title or "What was compared", part(own))
            title, own = block.text, []
        else:
            own.append(block)
