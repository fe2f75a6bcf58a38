"""Reports of audits: what they hold in every format, and that nothing in a publication is taken for markup."""

from __future__ import annotations

import io
import re
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path

import pytest
from rich.console import Console

from rttrr_pin.auditing import AuditResult, ComponentAudit, Finding, Kind, Publication, Verdict, read_publication
from rttrr_pin.auditing.errata import WRITERS, errata, left_side, prose
from rttrr_pin.auditing.evidence import Evidence
from rttrr_pin.auditing.page import audit_page
from rttrr_pin.auditing.report import show_audit, show_equations
from rttrr_pin.auditing.wording import dimension_summary, evidence_words, verdict_words
from rttrr_pin.derivation.writers.document import Code, Formula
from rttrr_pin.derivation.writers.html import mathml
from rttrr_pin.derivation.writers.typeset import settable
from rttrr_pin.reporting.files import as_json
from rttrr_pin.reporting.html import html
from support.pdflatex import compiled

TWO_LINK = Path(__file__).parents[2] / "examples/audit_two_link.toml"

NASTY = r"[bold]<script>alert(1)</script>[/] \input{x} $y$ %z & a_b #1 ~^ | `c` {{ d }} *e* \ "
"""Means something to every one of the writers, and must stand in each as it is."""

EVIDENCE = Evidence(pinocchio=-12.3456, printed_off=3.2, corrected_off=2e-15, enclosed=True, excluded=True)


@pytest.fixture(scope="module")
def textbook() -> Publication:
    return read_publication(TWO_LINK)


def component(*findings: Finding, **given) -> ComponentAudit:
    verdict = Verdict.DIFFERS if findings else Verdict.MATCH
    values = {
        "unit": "N m",
        "evidence": EVIDENCE,
        "proven": True,
        "corrected": ((r"m_1 \, l_1", False), (r"+ m_2 \, l_2", bool(findings))),
    }
    return ComponentAudit("tau_1", "tau1", 0, 2, 2, verdict, findings=findings, **(values | given))


def finding(
    kind: Kind = Kind.SIGN, printed: str | None = "- m_2 l_2", derived: str | None = r"m_2 \, l_2", **given
) -> Finding:
    return Finding("tau1.1", kind, printed, derived, given.pop("dimension_ok", True), **given)


def of(publication: Publication, *components: ComponentAudit) -> AuditResult:
    return AuditResult(publication, components, (), 0)


def shown(show, result: AuditResult, width: int = 80, **given) -> str:
    console = Console(width=width, file=io.StringIO(), highlight=False)
    show(result, console, **given)
    return console.file.getvalue()


# Counting


@pytest.mark.slow
def test_totals_add_up(of_the_paper: AuditResult) -> None:
    totals = of_the_paper.totals
    assert totals.components == sum(totals.verdicts.values()) == len(of_the_paper.components)
    assert totals.findings == sum(totals.kinds.values()) == len(of_the_paper.findings)
    assert 0 < totals.dimensionally_wrong <= sum(f.dimension_ok is False for f in of_the_paper.findings)


def test_a_term_with_two_errors_is_one_term_and_two_in_excess_are_two(textbook: Publication) -> None:
    two_errors = [finding(Kind.SYMBOL, dimension_ok=False), finding(Kind.SIGN, dimension_ok=False)]
    two_terms = [finding(Kind.EXTRA, "+ q_1", None, dimension_ok=False)] * 2
    wrong = component(*two_errors, *two_terms)
    assert [len(group) for group in wrong.by_term] == [2, 1, 1]
    assert of(textbook, wrong).totals.dimensionally_wrong == 3


def test_no_wrong_dimension_is_no_sentence(textbook: Publication) -> None:
    assert dimension_summary(of(textbook, component(finding())).totals) == ""
    assert dimension_summary(of(textbook, component(finding(dimension_ok=False))).totals)


# Evidence in words


@pytest.mark.parametrize(
    ("made", "told", "untold"),
    [
        (component(finding()), ["(seed 0) Pinocchio gives -12.3456 N m", "off by 3.2 N m", "by 2e-15 N m", "proven wrong", "symbolically equal"], []),
        (component(finding(), proven=False), ["could not be shown"], ["The corrected equation is symbolically"]),
        (component(finding(), evidence=replace(EVIDENCE, printed_off=None, excluded=None)), ["a symbol without a number"], ["proven wrong", "None"]),
        (component(finding(), evidence=replace(EVIDENCE, excluded=False)), ["meets it too"], ["proven wrong"]),
        (component(finding(), evidence=replace(EVIDENCE, enclosed=False)), ["does not meet"], []),
        (component(), ["the printed equation is off by 2e-15 N m", "the printed equation meets"], ["corrected", "wrong"]),
        (component(evidence=replace(EVIDENCE, corrected_off=0.0)), ["off by 0."], []),
    ],
)  # fmt: skip
def test_evidence_says_what_is_proven_and_no_more(textbook, made, told, untold) -> None:
    text = " ".join(evidence_words(of(textbook, made), made))
    assert all(words in text for words in told), text
    assert not any(words in text for words in untold), text


# The terminal


@pytest.mark.parametrize("width", [80, 110, 200])
def test_no_line_is_wider_than_the_terminal(of_the_paper: AuditResult, width: int) -> None:
    summary = shown(show_audit, of_the_paper, width)
    lines = [line for line in summary.splitlines() if not line.startswith(("in full:", "errata sheet:"))]
    assert max(map(len, [*lines, *shown(show_equations, of_the_paper, width).splitlines()])) <= width


def test_every_equation_and_verdict_is_in_the_table(of_the_paper: AuditResult) -> None:
    lines = {line.split()[0]: line for line in shown(show_audit, of_the_paper).splitlines() if line.startswith(" (")}
    for one in of_the_paper.components:
        assert verdict_words(one) in lines[f"({one.equation})"]


def test_details_show_every_finding_with_its_terms(of_the_paper: AuditResult) -> None:
    text = shown(show_equations, of_the_paper, 2000)
    for one in of_the_paper.components:
        for found in one.findings:
            assert re.search(rf"^  {re.escape(found.id)} +{found.kind}", text, re.MULTILINE)
            assert (found.printed or "(nothing)") in text
        changed = [term.replace(r" \, ", " ") for term, is_changed in one.corrected if is_changed]
        assert all(f"[{term}]" in text for term in changed)


def test_the_next_command_names_the_file_and_an_equation_that_differs(textbook: Publication) -> None:
    text = shown(show_audit, of(textbook, component(finding())), 200, file="my file.toml")
    assert "rttrr-pin audit 'my file.toml' --equation tau_1" in text
    assert "--markdown" in text
    assert "--equation" not in shown(show_audit, of(textbook, component()))


def test_a_publication_of_definitions_alone_has_an_empty_report(textbook: Publication) -> None:
    nothing = of(replace(textbook, equations=()))
    assert "ALL RIGHT" in shown(show_audit, nothing)
    assert all(errata(nothing, form) for form in WRITERS)


# JSON


def test_json_says_the_whole_of_it(of_the_paper: AuditResult) -> None:
    data = of_the_paper.to_dict()
    assert as_json(data)
    assert data["schema"] == 1 and not data["passed"] and len(data["components"]) == len(of_the_paper.components)
    assert {c["unit"] for c in data["components"]} == {"m/s^2", "N", "N m"}
    for told, one in zip(data["components"], of_the_paper.components, strict=True):
        assert [(x["term"], x["changed"]) for x in told["corrected"]] == list(one.corrected)
        assert [f["note"] for f in told["findings"]] == [f.note for f in one.findings]
    flipped = [check for check in data["conventions"] if check["flip"]]
    assert flipped and all(check["findings"] < check["otherwise"] for check in flipped)


# Errata sheets


def sheet(result: AuditResult, form: str) -> str:
    return html(audit_page(result)) if form == "html" else errata(result, form)


@pytest.mark.parametrize("form", [*WRITERS, "html"])
def test_every_finding_is_on_the_sheet_and_every_change_is_marked(of_the_paper: AuditResult, form: str) -> None:
    text = sheet(of_the_paper, form)
    for found in of_the_paper.findings:
        assert found.id in text
    changed = sum(is_changed for one in of_the_paper.components if one.findings for _, is_changed in one.corrected)
    mark = {"markdown": r"\boxed{", "latex": "\n" + r"\changed{", "html": "<mark>"}[form]
    assert text.count(mark) == changed
    for one in of_the_paper.components:
        assert one.quantity in text


@pytest.mark.parametrize("form", [*WRITERS, "html"])
def test_nothing_in_a_publication_is_markup(textbook: Publication, form: str) -> None:
    publication = replace(textbook, title=NASTY, source=NASTY)
    made = component(finding(printed=NASTY, derived=NASTY, note=NASTY), notes=(NASTY,), corrected=((NASTY, True),))
    unread = replace(component(), quantity="tau2", verdict=Verdict.UNPARSED, unparsed=NASTY, evidence=None)
    text = sheet(of(publication, made, unread), form)
    if form == "html":
        assert "<script" not in text and text.count("&lt;script&gt;") >= 6
        assert_nested(text)
    if form == "latex":
        assert r"\input{" not in re.sub(r"\\begin{verbatim}.*?\\end{verbatim}", "", text, flags=re.DOTALL)
        assert_balanced(text)
    if form == "markdown":
        outside = re.sub(r"```.*?```", "", text, flags=re.DOTALL)
        assert not re.search(r"(?<!\\)<script", re.sub(r"`+ .*? `+", "", outside))
        rows = [row for row in outside.splitlines() if row.startswith("| tau1.1")]
        assert [len(re.findall(r"(?<!\\)\|", row)) for row in rows] == [6]
    full = shown(show_equations, of(publication, made, unread), 400)
    assert full.startswith("[bold]<script>")
    assert re.search(r"^  why +\[bold\]<script>", full, re.MULTILINE)
    assert shown(show_audit, of(publication, made, unread), 400).startswith("[bold]<script>")


def assert_balanced(text: str) -> None:
    body = re.sub(r"\\begin{verbatim}.*?\\end{verbatim}", "", text, flags=re.DOTALL)
    environments: list[str] = []
    for word, name in re.findall(r"\\(begin|end){(\w+)}", body):
        if word == "begin":
            environments.append(name)
        else:
            assert environments.pop() == name
    assert not environments
    depth = 0
    for sign in re.sub(r"\\[\\{}]", "", body):
        depth += (sign == "{") - (sign == "}")
        assert depth >= 0
    assert depth == 0


class Nesting(HTMLParser):
    """Every element that is opened is closed, in order."""

    VOID = ("meta", "mspace")

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: set[str] = set()

    def handle_starttag(self, tag, attributes) -> None:
        self.tags.add(tag)
        assert not {name for name, _ in attributes} & {"src", "onclick", "srcset"}
        assert all(value.startswith("#") for name, value in attributes if name == "href")
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attributes) -> None:
        self.tags.add(tag)

    def handle_endtag(self, tag) -> None:
        if tag not in self.VOID:
            assert self.open.pop() == tag


def assert_nested(text: str) -> Nesting:
    parser = Nesting()
    parser.feed(text)
    assert parser.open == []
    return parser


def test_the_page_stands_by_itself(of_the_paper: AuditResult) -> None:
    text = html(audit_page(of_the_paper))
    tags = assert_nested(text).tags
    assert "math" in tags and not tags & {"script", "link", "img", "iframe"}
    assert set(re.findall(r"https?://[^\"' )]+", text)) == {"http://www.w3.org/1998/Math/MathML"}


def test_all_that_is_derived_in_the_paper_s_letters_can_be_set(of_the_paper: AuditResult) -> None:
    terms = {term for one in of_the_paper.components for term, _ in one.corrected}
    terms |= {f.derived for f in of_the_paper.findings if f.derived}
    assert all(settable(term) for term in terms)
    assert all("<math" in mathml(term) for term in terms)


def test_the_latex_is_balanced(of_the_paper: AuditResult) -> None:
    assert_balanced(errata(of_the_paper, "latex"))


@pytest.mark.tex
@pytest.mark.parametrize("case", ["paper", "nasty", "long"])
def test_the_latex_compiles(of_the_paper: AuditResult, textbook: Publication, case: str, tmp_path: Path) -> None:
    made = component(finding(printed=NASTY, derived=NASTY, note=NASTY), corrected=((NASTY, True),))
    if case == "long":
        long = " \\, ".join(["+ m_2", *[rf"\dot{{\theta}}_1^{k}" for k in range(2, 30)]])
        made = component(finding(printed=None, derived=long), corrected=((r"m_1", False), ("+ m_2", True)))
    result = of_the_paper if case == "paper" else of(replace(textbook, title=NASTY), made)
    found = compiled(errata(result, "latex"), tmp_path)
    assert case == "nasty" or not found.overfull


def test_an_equation_in_python_is_shown_as_code(textbook: Publication) -> None:
    made = component(
        finding(printed="- m_2*l_2", derived="m_2*l_2"), corrected=(("m_1*l_1", False), ("+ m_2*l_2", True))
    )
    result = of(replace(textbook, language="python"), made)
    assert "```python\ntau1 = (\n    m_1*l_1\n    + m_2*l_2  # changed\n)\n```" in errata(result, "markdown")
    assert "<code>- m_2*l_2</code>" in html(audit_page(result))
    assert r"\begin{verbatim}" in errata(result, "latex")


@pytest.mark.parametrize(
    ("name", "tex"),
    [("F5z", "F_{5z}"), ("vC12x", r"\dot{v}_{C_{12x}}"), ("tau10", r"\tau_{10}"), ("n1y", "n_{1y}")],
)
def test_left_sides(name: str, tex: str) -> None:
    assert left_side(name) == tex


SETTABLE = [
    r"- 2 \, {}^5r_{C_{5x}} \, c^2q_5 \, \dot{q}_1 \, \dot{q}_4",
    r"-M_3 \cdot (... + \dot{q}_1^3 r_{C_{3y}} ...)",
    r"- sq_5 M_5\cdot^5r_{C_{5x}}\dot{q}_5^2",
    r"\left({}^5J_x^*\right)^2",
    r"\frac{1}{2} \ddot q_1",
    r"\dot{\theta}_1^2 s_{12}",
    r"x'_1",
    "q_1{r}_2",
]
NOT_SETTABLE = [
    "", "  ", "q_{1", "q_1}", r"\left( x", r"x \right)", r"\left( { \right) }", "q_1_2", "q^2^3", "x'^2", "{q}_1_2", "q_", "q^", "q_}", "{q^}",
    r"\dot", r"{\dot}", r"\foo x", r"\text{a}", r"\begin{x}", "a & b", "a $ b", "a % b", r"a \\ b", r"\href{x}{y}", "é", "a | b",
    r"\dot{q}_1^2^5r", "<b>", r"\input{x}",
]  # fmt: skip


@pytest.mark.parametrize("tex", SETTABLE)
def test_what_can_be_set(tex: str) -> None:
    assert settable(tex)
    assert "<math" in mathml(tex)


@pytest.mark.parametrize("tex", NOT_SETTABLE)
def test_what_cannot_be_set_is_code(tex: str) -> None:
    assert not settable(tex)
    assert "<math" not in mathml(tex)


def test_prose_sets_formulas_and_names_apart() -> None:
    line = prose(r"read as `{}^5r_{C_{5x}}`, the 5 before it; J_xy of {5}, `- \right]` is link's")
    assert [type(part) for part in line] == [str, Formula, str, Code, str, Code, str]
    assert line[1] == Formula("{}^5r_{C_{5x}}") and line[3] == Code("J_xy") and line[5] == Code(r"- \right]")
    assert prose(r"so \dot{q}_1, x") == ("so ", Formula(r"\dot{q}_1"), ", x")
    assert "".join(part for part in line if isinstance(part, str)) == "read as , the 5 before it;  of {5},  is link's"
