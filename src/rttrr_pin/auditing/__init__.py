"""Published equations: read, held term by term against the recursion, and set right."""

from __future__ import annotations

from rttrr_pin.auditing.audit import audit
from rttrr_pin.auditing.edits import Kind
from rttrr_pin.auditing.file import read_publication
from rttrr_pin.auditing.findings import Finding
from rttrr_pin.auditing.publication import Publication
from rttrr_pin.auditing.verdicts import Audit, ComponentAudit, Verdict

__all__ = ["Audit", "ComponentAudit", "Finding", "Kind", "Publication", "Verdict", "audit", "read_publication"]
