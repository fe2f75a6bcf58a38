"""Diagnoses as text: what is left out is counted."""

from __future__ import annotations

from dataclasses import replace

from rich.console import Console

from rttrr_pin import load
from rttrr_pin.diagnosis import Cause, diagnose
from rttrr_pin.diagnosis.report import OTHERS, show_diagnosis


def test_other_sets_of_causes_are_counted_where_not_all_are_shown() -> None:
    agrees = diagnose(load("trr"), "recursion", n_states=5)
    cause = Cause("mass ignored", "the mass of link_1 is not counted", "count it", "a program")
    result = replace(agrees, others=((cause,),) * (OTHERS + 2))
    brief, whole = Console(width=200, record=True), Console(width=200, record=True)
    show_diagnosis(result, brief)
    show_diagnosis(result, whole, full=True)
    texts = [console.export_text() for console in (brief, whole)]
    assert [text.count("the mass of link_1 is not counted") for text in texts] == [OTHERS, OTHERS + 2]
    assert ["or one of 2 more; --full shows all" in text for text in texts] == [True, False]
