"""Published equations: read, held term by term against the recursion, and set right."""

from __future__ import annotations

from rttrr_pin.paper.audit import audit
from rttrr_pin.paper.edits import Kind
from rttrr_pin.paper.file import read_publication
from rttrr_pin.paper.findings import Finding
from rttrr_pin.paper.publication import Publication
from rttrr_pin.paper.verdicts import Audit, ComponentAudit, Verdict

__all__ = ["Audit", "ComponentAudit", "Finding", "Kind", "Publication", "Verdict", "audit", "read_publication"]
