"""Audits of equations of small robots, and what is expected of them."""

from __future__ import annotations

from pathlib import Path

from rttrr_pin.auditing import Verdict, audit, read_publication
from rttrr_pin.auditing.results import AuditResult, ComponentAudit


def audited(folder: Path, head: str, *equations: tuple[str, str], language: str = "latex") -> AuditResult:
    """Equations, each with what it states, such as `quantity = "M"\nrow = 1`."""
    tables = (f"[[equation]]\n{about}\n{language} = '''{text}'''\n" for about, text in equations)
    (folder / "a.toml").write_text(head + "".join(tables))
    return audit(read_publication(folder / "a.toml"))


def only(result: AuditResult) -> ComponentAudit:
    (component,) = result.components
    return component


def assert_right(result: AuditResult) -> None:
    for component in result.components:
        assert component.verdict is Verdict.MATCH, (component.quantity, component.unparsed, component.undeclared)
        assert component.proven and component.evidence is not None
        assert component.evidence.enclosed and component.evidence.excluded is False
        assert component.evidence.corrected_off < 1e-9


def assert_wrong(component: ComponentAudit) -> None:
    assert component.verdict is Verdict.DIFFERS and component.findings, component
    assert component.proven and component.evidence is not None
    assert component.evidence.excluded and component.evidence.enclosed
