"""A viser server that nobody but this machine reaches."""

from __future__ import annotations

import errno
import io
import os
import socket
from contextlib import redirect_stdout
from typing import TYPE_CHECKING, Any
from urllib.parse import urlsplit

from rttrr_pin.errors import InputError

if TYPE_CHECKING:
    import viser

HOST = "127.0.0.1"

LOOPBACK = (HOST, "localhost", "::1")


def open_server(port: int, label: str) -> viser.ViserServer:
    """Serve on a port of this machine; 0 is any that is free.

    Raises:
        InputError: viser is not installed, or the port is not to be had.
    """
    _check_free(port)
    try:
        import viser
    except ImportError as error:
        raise InputError(
            f"viewing needs the package {error.name!r}, which is not installed: pip install 'rttrr-pin[view]'"
        ) from error

    class Local(viser.ViserServer):
        """Has no link for others: viser would tunnel it through a machine of its own."""

        def request_share_url(self, verbose: bool = True) -> str | None:
            return None

    os.environ.pop("_VISER_PORT_OVERRIDE", None)
    with redirect_stdout(io.StringIO()):  # its banner
        server = Local(host=HOST, port=port, label=label, verbose=False)
    if port and server.get_port() != port:  # taken in between: viser took another
        close(server)
        raise _refused(port, os.strerror(errno.EADDRINUSE))
    server.gui.configure_theme(show_logo=False, show_share_button=False)
    _refuse_other_pages(server)
    return server


def address(server: viser.ViserServer) -> str:
    """Where a browser finds it."""
    return f"http://{HOST}:{server.get_port()}"


def close(server: viser.ViserServer) -> None:
    """Serve no more."""
    with redirect_stdout(io.StringIO()):  # its farewell
        server.stop()


def _check_free(port: int) -> None:
    """The port can be had: viser itself would take the next one, or try for ever."""
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind((HOST, port))
        except OverflowError:
            raise InputError(f"port is {port}: expected 0 to 65535", options={"port": "--port"}) from None
        except OSError as error:
            raise _refused(port, error.strerror or str(error)) from error


def _refused(port: int, reason: str) -> InputError:
    return InputError(
        f"port {port} of this machine cannot be had: {reason}; choose another one, or 0 for any that is free",
        options={"port": "--port"},
    )


def _refuse_other_pages(server: viser.ViserServer) -> None:
    """A page of another site, open in the same browser, does not get to read or move the robot."""
    websockets: Any = server._websock_server

    async def check(connection: Any) -> None:
        socket = websockets._live_connections[connection.client_id]
        headers = socket.request.headers
        host, origin = headers.get("Host", ""), headers.get("Origin")
        if urlsplit(f"//{host}").hostname not in LOOPBACK or (origin and urlsplit(origin).netloc != host):
            await socket.close(1008, "another site")

    websockets.on_client_connect(check)
