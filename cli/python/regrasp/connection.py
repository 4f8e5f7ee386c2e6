"""One connection to the daemon: JSON-RPC 2.0, one object per line, answers with the number of the request."""

import json
import select
import socket
import threading


class Error(RuntimeError):
    """The daemon refused a request. `code` as in docs/protocol.md; `hint`, `param`, `allowed`, `errors` where it gave them."""

    def __init__(self, method, error):
        data = error.get("data") or {}
        self.method, self.code = method, error["code"]
        self.hint, self.param, self.allowed, self.errors = (data.get(key) for key in ("hint", "param", "allowed", "errors"))
        super().__init__(f"{method}: {error['message']}" + (f" (try: {self.hint})" if self.hint else ""))


class Job:
    """Work that the daemon has begun: what `grasp`, `explore`, `rotate`, ... return."""

    def __init__(self, connection, number):
        self._connection, self.id = connection, number

    def __repr__(self):
        return f"Job({self.id})"

    def get(self):
        """Its record now: `state`, `progress` and what it has found so far."""
        return self._connection.call("job.get", id=self.id)

    def wait(self, timeout_s=None):
        """Its record once it has ended, whatever the end was. Raises Error (-32004) after `timeout_s` of wall clock."""
        limit = {} if timeout_s is None else {"timeout_s": timeout_s}
        return self._connection.call("job.wait", id=self.id, **limit)

    def done(self, timeout_s=None):
        """Like `wait`, but raises RuntimeError unless the job ended with `done`."""
        record = self.wait(timeout_s)
        if record["state"] != "done":
            raise RuntimeError(f"job {self.id} {record['method']}: {record['state']}: {record.get('error') or ''}")
        return record

    def cancel(self):
        """Ends it; the hand goes on holding."""
        return self._connection.call("job.cancel", id=self.id)


class Connection:
    """A connection to the socket `path`. Raises OSError when nobody listens there.

    Threads may share it: their calls come one after the other, and each gets its own answer. A call that waits (`wait`
    of a Job) holds up those of the other threads; who wants to cancel it meanwhile needs a connection of his own."""

    def __init__(self, path):
        self.path = str(path)
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        try:
            self._socket.connect(self.path)
        except OSError:
            self._socket.close()
            raise
        self._waiting = select.poll()
        self._waiting.register(self._socket, select.POLLIN)
        self._received = b""  # what follows the last line that was read
        self._last_id = 0
        # Of one thread at a time. A signal's handler that calls while its own thread does is refused by poll().
        self._turn = threading.RLock()

    def close(self):
        self._socket.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def _read(self):
        # An interrupt comes while it waits, when nothing has been taken from the socket yet.
        while b"\n" not in self._received:
            self._waiting.poll()
            chunk = self._socket.recv(1 << 20)
            if not chunk:
                raise ConnectionError(f"{self.path}: the daemon closed the connection")
            self._received += chunk
        line, _, self._received = self._received.partition(b"\n")
        return json.loads(line)

    def call(self, method, /, **params):
        """The result of one request. Raises Error when the daemon refuses it; nothing has changed then."""
        with self._turn:
            self._last_id += 1
            request = {"jsonrpc": "2.0", "id": self._last_id, "method": method, "params": params}
            self._socket.sendall(json.dumps(request, allow_nan=False).encode() + b"\n")
            # Passed over: notifications of a subscription made with call(), answers to calls that were interrupted.
            while "id" not in (answer := self._read()) or answer["id"] not in (None, self._last_id):
                pass
        if "error" in answer:
            raise Error(method, answer["error"])
        return answer["result"]

    def watch(self, topic, rate_hz=None, count=None):
        """Samples of a topic as they come, on a connection of their own: an iterator of dicts. It ends after `count`
        samples, or when it is closed. `dropped` counts samples that were left out because the reader was slow."""
        with Connection(self.path) as stream:
            stream.call("subscribe", topic=topic, **({} if rate_hz is None else {"rate_hz": rate_hz}))
            given = 0
            while count is None or given < count:
                message = stream._read()
                if message.get("method") == "event":
                    given += 1
                    yield message["params"]
