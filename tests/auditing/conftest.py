"""One audit of the paper for all tests of this room: it takes seconds."""

from __future__ import annotations

import pytest

from rttrr_pin.auditing import AuditResult, Publication, audit, read_publication


@pytest.fixture(scope="session")
def paper() -> Publication:
    return read_publication()


@pytest.fixture(scope="session")
def of_the_paper(paper: Publication) -> AuditResult:
    return audit(paper)
