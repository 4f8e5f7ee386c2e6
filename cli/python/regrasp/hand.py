"""A hand: every method of the daemon, and a private daemon where one is wanted."""

import os
import pathlib
import shutil
import subprocess
import tempfile
import time

from .connection import Connection
from .methods import Methods

START_LIMIT_S = 60  # of wall clock, for a daemon to answer


class Hand(Methods, Connection):
    """A connection with every method of the daemon. `daemon`: the private daemon that ends with it, or None."""

    def __init__(self, path, daemon=None):
        Connection.__init__(self, path)
        self._daemon = daemon

    @property
    def output_dir(self):
        """Where the daemon writes pictures and run files."""
        return pathlib.Path(self.call("status")["output_dir"])

    def close(self):
        Connection.close(self)
        if self._daemon is not None:
            self._daemon.stop()
            self._daemon = None


def find_socket():
    """Where `regrasp` looks: $REGRASP_SOCKET, then the first place of `regrasp up` where a socket is."""
    if named := os.environ.get("REGRASP_SOCKET"):
        return named
    folders = [os.environ.get("XDG_RUNTIME_DIR", "/run") + "/regrasp", "/run/regrasp", f"/tmp/regrasp-{os.getuid()}"]
    paths = [folder + "/regrasp.sock" for folder in folders]
    return next(filter(os.path.exists, paths), paths[0])


def connect(path=None):
    """A Hand of a daemon that runs: at the socket `path`, else where `regrasp` looks."""
    return Hand(path or find_socket())


def find_daemon():
    """The program `regraspd`: in $REGRASP_BIN_DIR, else in the build of this source tree, else on the PATH."""
    if named := os.environ.get("REGRASP_BIN_DIR"):
        return str(pathlib.Path(named) / "regraspd")
    built = pathlib.Path(__file__).resolve().parents[3] / "build" / "release" / "bin" / "regraspd"
    if built.exists():
        return str(built)
    if found := shutil.which("regraspd"):
        return found
    raise FileNotFoundError("regraspd is neither in $REGRASP_BIN_DIR nor built here nor on the PATH")


def start(seed=1, hand=None, object=None, noise=None, clock="lockstep", stepper=None, output_dir=None, **settings):
    """A Hand of a private daemon at full speed, which ends when the Hand is closed.

    seed: of noise and start. hand, object: names or URDF files. noise: a preset. clock: "lockstep", the simulated time
    advances only while a job runs, or "continuous". stepper: "fast", "exact", "round" or "auto". output_dir: kept; without it what the
    daemon writes is deleted with it. settings: parameters, with __ for the dot: gait__mode="exploring".
    The configuration and environment of the user change nothing. Raises RuntimeError with the daemon's own words when it
    does not start."""
    words = ["--seed", str(seed), "--speed", "max", "--clock", clock, "--config", "/dev/null"]
    for option, value in (("--hand", hand), ("--object", object), ("--noise", noise), ("--stepper", stepper)):
        if value is not None:
            words += [option, str(value)]
    daemon = _Daemon(words, output_dir)
    try:
        connected = Hand(daemon.socket, daemon)
    except BaseException:
        daemon.stop()
        raise
    try:
        if settings:
            connected.call("param.load", parameters={name.replace("__", "."): value for name, value in settings.items()})
    except BaseException:
        connected.close()
        raise
    return connected


class _Daemon:
    """regraspd in a directory of its own under the temporary directory, until `stop`."""

    def __init__(self, words, output_dir):
        self._directory = tempfile.TemporaryDirectory(prefix="regrasp-python-")
        private = pathlib.Path(self._directory.name)
        self.socket = str(private / "regrasp.sock")
        output = pathlib.Path(output_dir) if output_dir else private / "output"
        environment = {k: v for k, v in os.environ.items() if not k.startswith("REGRASP_")}
        self._log = open(private / "log", "w+b")
        self._process = subprocess.Popen(
            [find_daemon(), "--socket", self.socket, "--output-dir", str(output), *words], env=environment,
            stdin=subprocess.DEVNULL, stdout=self._log, stderr=self._log)
        deadline = time.monotonic() + START_LIMIT_S
        while not self._answers():
            if self._process.poll() is not None or time.monotonic() > deadline:
                self._log.seek(0)
                said = self._log.read().decode(errors="replace").strip()
                self.stop()
                raise RuntimeError(f"regraspd did not start: {said}")
            time.sleep(0.01)

    def _answers(self):
        try:
            with Connection(self.socket) as probe:
                return bool(probe.call("version"))
        except (OSError, ValueError):
            return False

    def stop(self):
        self._process.terminate()
        self._process.wait()
        self._log.close()
        self._directory.cleanup()
