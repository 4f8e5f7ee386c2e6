#!/usr/bin/env bash
# The load that docs/promises.md speaks of, on a daemon of its own at real time, holding an object.
#   bench/load.sh [BIN] [SECONDS]    BIN: folder of the programs, build/release/bin by default
# redis-server's PING is measured beside it where that is installed. Prints the load of the machine first: other
# programs that compute at the same time make every figure worse.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
bin=$(realpath "${1:-build/release/bin}") seconds=${2:-60}
dir=$(mktemp -d)
redis_pid=
cleanup() {
  "$bin/regrasp" -s "$dir/r/s" down >/dev/null 2>&1 || true
  if [ -n "$redis_pid" ]; then kill "$redis_pid"; wait "$redis_pid" || true; fi
  rm -rf "$dir"
}
trap cleanup EXIT
redis=
if command -v redis-server >/dev/null; then
  redis-server --port 0 --unixsocket "$dir/redis" --save "" --dir "$dir" >/dev/null &
  redis_pid=$!
  redis=$dir/redis
fi
echo "load of the machine: $(cut -d' ' -f1-3 /proc/loadavg), $(nproc) cores"
"$bin/regrasp" -s "$dir/r/s" up --clock continuous --speed 1.0 --output-dir "$dir/out" >/dev/null
"$bin/regrasp" -s "$dir/r/s" grasp --wait >/dev/null
"$bin/load" "$dir/r/s" alone 20000 $redis
"$bin/load" "$dir/r/s" clients 64 "$seconds"
"$bin/load" "$dir/r/s" connects 10000
