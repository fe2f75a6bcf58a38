"""A file of its own: the scene as viser writes it, with a title, the state in words and its numbers."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from rttrr_pin.reporting.output import shown
from rttrr_pin.viewing.numbers import STYLE, joint_cells, joint_table, link_table, state_in_python, text
from rttrr_pin.viewing.panel import legend
from rttrr_pin.viewing.recording import Recording

if TYPE_CHECKING:
    from rttrr_pin.viewing.viewer import Viewer

FRAMES, RATE = 300, 25.0
"""Pictures of a trajectory in a file, at most, in all and in each second."""


def html_page(viewer: Viewer, playing: bool = True) -> str:
    """The state that a viewer shows, or its trajectory; nothing is loaded from elsewhere.

    Args:
        viewer: what is shown.
        playing: whether a trajectory plays in the file; else the state stays as it is.
    """
    from jinja2 import Environment, PackageLoader, StrictUndefined
    from markupsafe import Markup

    from rttrr_pin.version import __version__

    recording = viewer.subject.recording
    plays = playing and recording is not None and recording.rows.time is not None and len(recording.rows) > 1
    if plays and recording is not None:
        viewer.jump_to_row(0)
        viewer.show()
    title = shown(f"{viewer.model.name}: forces and moments")
    content = {"place": viewer.place, "worst": _worst(recording), "scale": viewer.look.scale}
    content |= {name: Markup(markup) for name, markup in _numbers(viewer).items()}
    scene, frames = _played(viewer, recording) if plays and recording else (_still(viewer), [])
    environment = Environment(
        loader=PackageLoader(__package__ or "", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
    )
    notes = [shown(note) for note in viewer.subject.notes]
    embedded = Markup(_json(frames)) if frames else ""
    aside = environment.get_template("aside.html").render(
        **content, title=title, notes=notes, frames=embedded, version=__version__
    )
    return _inserted(scene, title, aside)


def _still(viewer: Viewer) -> str:
    """The scene as it is."""
    return str(viewer.server.get_scene_serializer().as_html())


def _played(viewer: Viewer, recording: Recording) -> tuple[str, list[dict[str, Any]]]:
    """The scene of the first row with all that follows; and the numbers of each picture, with the second of each."""
    time = recording.rows.time
    assert time is not None
    count = int(min(FRAMES, np.ceil((time[-1] - time[0]) * RATE) + 1))
    rows = sorted({recording.at(t) for t in np.linspace(time[0], time[-1], max(count, 2))})
    serializer = viewer.server.get_scene_serializer()
    frames: list[dict[str, Any]] = []
    for k, row in enumerate(rows):
        if k:
            serializer.insert_sleep(float(time[row] - time[rows[k - 1]]))
            viewer.jump_to_row(row)
            viewer.show()
        cells = [] if viewer.numbers is None else joint_cells(viewer.model, viewer.whole_state, viewer.numbers)
        frames.append({"at": float(time[row] - time[0]), "place": viewer.place, "cells": cells})
    serializer.insert_sleep(1.0)  # before it begins again
    return serializer.as_html(), frames


def _worst(recording: Recording | None) -> str:
    return "" if recording is None else f"worst: {recording.place(recording.worst)}: {recording.why}"


def _numbers(viewer: Viewer) -> dict[str, str]:
    """The tables, as markup."""
    model, state, numbers = viewer.model, viewer.whole_state, viewer.numbers
    if numbers is None:
        return {"numbers": f"<p>error: {text(viewer.error)}</p>", "links": "", "python": "", "legend": ""}
    name = viewer.program if len(numbers.values) > 1 else ""
    values = numbers.values[viewer.program]
    return {
        "numbers": STYLE + joint_table(model, state, numbers),
        "links": "".join(link_table(model, i, values, name) for i in range(len(model.links))),
        "python": text(state_in_python(model, state)),
        "legend": legend(),
    }


def _json(data: object) -> str:
    """JSON that may stand in a script: it holds no angle bracket."""
    return json.dumps(data).replace("<", "\\u003c").replace(">", "\\u003e").replace("&", "\\u0026")


def _inserted(scene: str, title: str, aside: str) -> str:
    """The title in place of viser's, and what stands beside the scene at the end of the body."""
    head, end, tail = scene.rpartition("</body>")
    return head.replace("<title>Viser</title>", f"<title>{text(title)}</title>", 1) + aside + end + tail
