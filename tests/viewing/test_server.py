"""Nobody but this machine reaches the viewer, no other page of its browser either; and it ends when it is told to."""

from __future__ import annotations

import re
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from support.processes import left_behind

pytestmark = pytest.mark.browser


@contextmanager
def serving(*words: str) -> Iterator[tuple[subprocess.Popen[str], int]]:
    """The command in a process of its own, and its port."""
    process = subprocess.Popen(
        [sys.executable, "-m", "rttrr_pin", "view", "rttrr", *words],
        stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True,
    )  # fmt: skip
    try:
        assert process.stdout is not None
        said = process.stdout.readline()
        found = re.search(r"http://127\.0\.0\.1:(\d+)", said)
        assert found is not None, said
        yield process, int(found[1])
    finally:
        process.kill()
        process.communicate()


def listening(port: int) -> set[str]:
    """The addresses at which something listens at a port, as the kernel has them."""
    lines = [
        line.split() for name in ("tcp", "tcp6") for line in Path(f"/proc/net/{name}").read_text().splitlines()[1:]
    ]
    return {own[1].partition(":")[0] for own in lines if own[3] == "0A" and int(own[1].partition(":")[2], 16) == port}


@pytest.mark.parametrize(
    ("number", "code", "said"), [(signal.SIGINT, 130, "interrupted"), (signal.SIGTERM, 143, "terminated")]
)
def test_it_listens_here_alone_and_leaves_cleanly(number: int, code: int, said: str) -> None:
    with serving() as (process, port):
        assert listening(port) == {"0100007F"}
        process.send_signal(number)
        out, err = process.communicate(timeout=30)
        assert (process.returncode, out, err) == (code, "", f"{said}: nothing was written\n")
        assert left_behind(process.pid) == []


def test_pages_of_other_sites_are_refused() -> None:
    from viser import __version__
    from websockets.exceptions import ConnectionClosed
    from websockets.sync.client import connect

    with serving() as (_, port):

        def first_message(origin: str | None, host: str = "127.0.0.1") -> int:
            headers = {} if host == "127.0.0.1" else {"Host": host}
            with connect(
                f"ws://127.0.0.1:{port}",
                subprotocols=[f"viser-v{__version__}"],
                origin=origin,
                additional_headers=headers,
            ) as socket:
                return len(socket.recv(timeout=20))

        assert first_message(None) > 0
        assert first_message(f"http://127.0.0.1:{port}") > 0
        for origin in ("http://evil.example", f"http://evil.example:{port}", "null", f"http://127.0.0.1:{port + 1}"):
            with pytest.raises(ConnectionClosed, match="another site"):
                first_message(origin)


def test_nobody_is_given_a_link() -> None:
    from rttrr_pin.viewing.server import close, open_server

    server = open_server(0, "x")
    try:
        assert server.request_share_url() is None
        assert server.get_host() == "127.0.0.1"
    finally:
        close(server)


def test_no_port_but_the_one_that_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Not that of viser's own variable either."""
    monkeypatch.setenv("_VISER_PORT_OVERRIDE", "1")
    with serving() as (_, port):
        assert port > 1
