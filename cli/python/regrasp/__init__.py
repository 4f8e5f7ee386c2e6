"""regrasp from Python: a running daemon, or a private one, through its socket. Standard library only.

    import regrasp
    with regrasp.start(seed=1) as hand:
        hand.grasp().wait()
        print(hand.explore("ring").wait()["phi_true_final"])

`start` begins a private daemon whose clock advances only while a job runs, so the same lines give the same
figures; `connect` talks to a daemon that is there already. Every method of the daemon is a method of `Hand`, with
the names, units and ranges of docs/protocol.md. `runs` reads run files and the tables of experiments.
"""

from .connection import Connection, Error, Job
from .hand import Hand, connect, find_socket, start
from . import runs

__all__ = ["Connection", "Error", "Hand", "Job", "connect", "find_socket", "runs", "start"]
