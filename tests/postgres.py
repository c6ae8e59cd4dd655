"""A PostgreSQL server of the system, in a folder of its own, that may be killed and started again."""

import os
import pwd
import shutil
import signal
import subprocess
import tempfile
import time
from contextlib import suppress
from pathlib import Path

from tests.ports import free_port

DEADLINE = 60.0
DATABASE = "postgres"
USER = "slipjump"


def binaries():
    """Return the folder of the newest server that is installed, None where there is none."""
    found = sorted(Path("/usr/lib/postgresql").glob("*/bin/initdb"), key=lambda path: int(path.parts[-3]))
    return found[-1].parent if found else None


def _account():
    """The server refuses to run as root."""
    if os.geteuid() != 0:
        return {}
    entry = pwd.getpwnam("postgres")
    return {"user": entry.pw_uid, "group": entry.pw_gid, "extra_groups": []}


class Postgres:
    """One server on a port of the loopback; everybody on this machine is trusted."""

    def __init__(self):
        self._folder = Path(tempfile.mkdtemp(prefix="slipjump-pg-", dir="/tmp"))
        account = _account()
        if account:
            os.chown(self._folder, account["user"], account["group"])
        self._account = account
        self.port = free_port()
        self._run("initdb", "-D", "data", "-U", USER, "-A", "trust", "--no-sync", "-E", "UTF8", "--locale=C")
        self._server = None

    @property
    def url(self):
        return f"postgresql://{USER}@127.0.0.1:{self.port}/{DATABASE}"

    def start(self):
        """Start it and wait until it answers."""
        words = ["-D", "data", "-p", str(self.port), "-k", ".", "-c", "listen_addresses=127.0.0.1"]
        quiet = ["-c", "shared_buffers=16MB", "-c", "max_connections=20", "-c", "logging_collector=off"]
        self._server = subprocess.Popen(
            [binaries() / "postgres", *words, *quiet],
            cwd=self._folder,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            **self._account,
        )
        end = time.monotonic() + DEADLINE
        ready = [binaries() / "pg_isready", "-q", "-h", "127.0.0.1", "-p", str(self.port)]
        while subprocess.run(ready, check=False).returncode != 0:
            assert self._server.poll() is None, "the server ended"
            assert time.monotonic() < end, "the server does not answer"
            time.sleep(0.02)

    def kill(self):
        """End it as a crash of the machine does."""
        children = Path(f"/proc/{self._server.pid}/task/{self._server.pid}/children").read_text().split()
        for pid in [self._server.pid, *map(int, children)]:
            with suppress(ProcessLookupError):
                os.kill(pid, signal.SIGKILL)
        self._server.wait()
        (self._folder / "data" / "postmaster.pid").unlink(missing_ok=True)

    def close(self):
        if self._server is not None and self._server.poll() is None:
            self._server.send_signal(signal.SIGQUIT)
            self._server.wait()
        shutil.rmtree(self._folder, ignore_errors=True)

    def _run(self, program, *words):
        subprocess.run(
            [binaries() / program, *words],
            cwd=self._folder,
            check=True,
            stdout=subprocess.DEVNULL,
            **self._account,
        )
