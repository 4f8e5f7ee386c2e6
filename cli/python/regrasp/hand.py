"""A hand: every method of the daemon, and a private daemon where one is wanted."""

import fcntl
import os
import pathlib
import shutil
import subprocess
import tempfile
import time
import tomllib
import weakref

from .connection import Connection
from .methods import Methods

START_LIMIT_S = 60  # of wall clock, for a daemon to answer


class Hand(Methods, Connection):
    """A connection with every method of the daemon. `daemon`: the private daemon that ends with it, or None: when it is
    closed, when nobody has it any more, at the latest with the interpreter. Threads may share it as they may a
    Connection; `connect(hand.path)` makes another one to the same daemon."""

    def __init__(self, path, daemon=None):
        Connection.__init__(self, path)
        self._daemon = daemon
        if daemon is not None:
            weakref.finalize(self, daemon.stop)

    @property
    def output_dir(self):
        """Where the daemon writes pictures and run files."""
        return pathlib.Path(self.call("status")["output_dir"])

    def close(self):
        Connection.close(self)
        if self._daemon is not None:
            self._daemon.stop()


def _directory_variable(name):
    """$NAME where it is an absolute path, else "": relative ones are ignored."""
    value = os.environ.get(name, "")
    return value if os.path.isabs(value) else ""


def configured_socket():
    """`socket` of the configuration file, or None: of $REGRASP_CONFIG, else of the first regrasp/regraspd.toml in
    $XDG_CONFIG_HOME (~/.config) and /etc. Raises OSError and ValueError where the file cannot be read."""
    file = os.environ.get("REGRASP_CONFIG")
    if not file:
        home = _directory_variable("XDG_CONFIG_HOME") or os.path.expanduser("~/.config")
        file = next(filter(os.path.exists, (folder + "/regrasp/regraspd.toml" for folder in (home, "/etc"))), None)
    if not file:
        return None
    with open(file, "rb") as text:
        try:
            named = tomllib.load(text).get("socket")
        except ValueError as error:
            raise ValueError(f"{file}: {error}") from None
    if named is None or named == "":
        return None
    place = named if isinstance(named, str) else ""
    if place.startswith("~/"):
        place = os.path.expanduser(place)
    if not os.path.isabs(place):
        raise ValueError(f"{file}: socket = {named!r}: expected an absolute path, or one that begins with ~/")
    return place


def find_socket():
    """Where `regrasp` looks: $REGRASP_SOCKET, the configuration file, then the first place of `regrasp up` where a
    socket is."""
    if named := os.environ.get("REGRASP_SOCKET") or configured_socket():
        return named
    folders = [(_directory_variable("XDG_RUNTIME_DIR") or "/run") + "/regrasp", "/run/regrasp", f"/tmp/regrasp-{os.getuid()}"]
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
    words = ["--seed", str(seed), "--speed", "max", "--clock", clock, "--config", "/dev/null", "--until-eof"]
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


def _remove_abandoned(path):
    """Removes a directory that is this user's where neither the program that made it nor its daemon lives: both have a lock.
    Ours is held until it has gone: somebody who has just made it waits for that."""
    try:
        directory = os.open(path, os.O_RDONLY | os.O_DIRECTORY | os.O_NOFOLLOW)
    except OSError:
        return
    locks = [directory]
    try:
        if os.fstat(directory).st_uid != os.geteuid():
            return
        fcntl.flock(directory, fcntl.LOCK_EX | fcntl.LOCK_NB)
        try:
            locks.append(os.open("regrasp.sock.lock", os.O_RDONLY | os.O_NOFOLLOW, dir_fd=directory))
            fcntl.flock(locks[1], fcntl.LOCK_EX | fcntl.LOCK_NB)
        except FileNotFoundError:
            pass  # there was no daemon
        shutil.rmtree(path, ignore_errors=True)
    except OSError:
        return
    finally:
        for lock in locks:
            os.close(lock)


def private_directory():
    """A new directory, and its lock, for a private daemon. What others left behind there whose program was killed goes."""
    base = tempfile.gettempdir()
    if len(os.fsencode(base)) > 107 - len("/regrasp-python-XXXXXXXX/regrasp.sock"):
        base = "/tmp"  # the path of a socket has at most 107 bytes
    for left in (*pathlib.Path(base).glob("regrasp-private-*"), *pathlib.Path(base).glob("regrasp-python-*")):
        _remove_abandoned(left)
    while True:
        directory = tempfile.mkdtemp(prefix="regrasp-python-", dir=base)
        try:
            lock = os.open(directory, os.O_RDONLY | os.O_DIRECTORY)
        except FileNotFoundError:
            continue  # somebody swept before it had a lock
        fcntl.flock(lock, fcntl.LOCK_SH)
        if os.path.exists(directory):
            return directory, lock
        os.close(lock)


class _Daemon:
    """regraspd in a directory of its own under the temporary directory, until `stop`. In a session of its own: Ctrl-C at
    a terminal ends a call, not the daemon, which ends with the interpreter: that has the other end of its input."""

    def __init__(self, words, output_dir):
        program = find_daemon()
        self._owner = os.getpid()
        self._directory, self._lock = private_directory()
        private = pathlib.Path(self._directory)
        self.socket = str(private / "regrasp.sock")
        output = pathlib.Path(output_dir) if output_dir else private / "output"
        environment = {k: v for k, v in os.environ.items() if not k.startswith("REGRASP_")}
        self._log = open(private / "log", "w+b")
        self._process = subprocess.Popen(
            [program, "--socket", self.socket, "--output-dir", str(output), *words], env=environment,
            stdin=subprocess.PIPE, stdout=self._log, stderr=self._log, start_new_session=True)
        try:
            self._wait()
        except BaseException:
            self.stop()
            raise

    def _wait(self):
        deadline = time.monotonic() + START_LIMIT_S
        while not self._answers():
            if self._process.poll() is not None or time.monotonic() > deadline:
                self._log.seek(0)
                raise RuntimeError(f"regraspd did not start: {self._log.read().decode(errors='replace').strip()}")
            time.sleep(0.01)

    def _answers(self):
        try:
            with Connection(self.socket) as probe:
                return bool(probe.call("version"))
        except (OSError, ValueError):
            return False

    def stop(self):
        if self._log.closed or os.getpid() != self._owner:  # a fork has the parent's daemon
            return
        self._process.terminate()
        self._process.wait()
        self._process.stdin.close()
        self._log.close()
        shutil.rmtree(self._directory, ignore_errors=True)
        os.close(self._lock)
