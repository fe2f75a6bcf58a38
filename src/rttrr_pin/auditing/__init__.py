"""Published equations: read, compared term by term with the recursion, and corrected."""

from __future__ import annotations

from rttrr_pin.auditing.differences import Kind
from rttrr_pin.auditing.file import read_publication
from rttrr_pin.auditing.pipeline import audit
from rttrr_pin.auditing.publication import Publication
from rttrr_pin.auditing.results import AuditResult, ComponentAudit, Finding, Verdict

__all__ = ["AuditResult", "ComponentAudit", "Finding", "Kind", "Publication", "Verdict", "audit", "read_publication"]
