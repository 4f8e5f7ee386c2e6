#!/usr/bin/env python3
"""Does the least-squares gradient of Algorithm 1 gain more than the printed rule? The same starts under both.

    python3 study.py [SEEDS]          needs no daemon: it starts a private one
"""

import statistics
import sys

import regrasp


def gain(hand, seed, estimator):
    """Noise-free rise of manipulability of the ring finger, in percent, from the start that `seed` makes."""
    hand.reset(seed=seed)
    hand.grasp().done()
    job = hand.explore("ring", estimator=estimator).wait()
    return 100 * (job["phi_true_final"] / job["phi_true_initial"] - 1)


count = sys.argv[1] if len(sys.argv) > 1 else "5"
if not count.isdigit() or int(count) == 0:
    sys.exit(f"study.py: SEEDS is {count!r}; allowed are 1, 2, ...")
seeds = range(1, 1 + int(count))
with regrasp.start() as hand:
    pairs = [(gain(hand, s, "least_squares"), gain(hand, s, "secant")) for s in seeds]
for seed, (ours, printed) in zip(seeds, pairs):
    print(f"seed {seed}: {ours:+.2f} % by least squares, {printed:+.2f} % by the printed rule")
print(f"median difference {statistics.median(a - b for a, b in pairs):+.2f} percentage points, n = {len(pairs)}")
