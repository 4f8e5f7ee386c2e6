#!/bin/sh
# Grasps the object and turns it by 90 degrees, with nothing but a shell and nc (netcat-openbsd).
#   regrasp up --speed max && sh grasp_and_turn.sh [SOCKET]
set -eu
socket=${1:-${REGRASP_SOCKET:-}}
if [ -z "$socket" ]; then # the first that is there of the places where `regrasp up` puts it
  for folder in "${XDG_RUNTIME_DIR:-/run}/regrasp" /run/regrasp "/tmp/regrasp-$(id -u)"; do
    socket=$folder/regrasp.sock
    if [ -S "$socket" ]; then break; fi
  done
fi

# ask METHOD [PARAMS]: one request, one line of answer. nc ends when the daemon has answered (-N).
ask() {
  printf '{"jsonrpc":"2.0","id":1,"method":"%s","params":%s}\n' "$1" "${2:-{\}}" | nc -U -N "$socket"
}

# wait_for ANSWER: the record of the job that ANSWER names, once it has ended; it must have done what was asked.
wait_for() {
  job=$(printf '%s' "$1" | sed -n 's/.*"job":\([0-9]*\).*/\1/p')
  if [ -z "$job" ]; then
    echo "refused: $1" >&2
    exit 5
  fi
  record=$(ask job.wait "{\"id\":$job}")
  printf '%s\n' "$record"
  case $record in
    *'"state":"done"'*) ;;
    *) exit 1 ;;
  esac
}

if [ ! -S "$socket" ] || ! ask status >/dev/null 2>&1; then
  echo "no daemon: nobody answers on $socket; try: regrasp up --speed max" >&2
  exit 3
fi
wait_for "$(ask grasp)"
wait_for "$(ask rotate '{"angle_rad":1.5708}')"
ask truth
