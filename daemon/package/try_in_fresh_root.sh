#!/usr/bin/env bash
# Builds the Debian package, installs it into a fresh Debian 12 (debootstrap), runs it there, removes
# it, and checks that nothing is left. Needs root, debootstrap and a mirror; a few minutes.
#   daemon/package/try_in_fresh_root.sh [BUILD_DIRECTORY]      default: build/release
# $MIRROR: where Debian comes from.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
build=${1:-build/release}
mirror=${MIRROR:-http://deb.debian.org/debian}
root=$(mktemp -d /tmp/regrasp-root-XXXXXX)
trap 'umount "$root/proc" 2>/dev/null || true; rm -rf --one-file-system "$root"' EXIT

say() { printf '== %s\n' "$*"; }
inside() { chroot "$root" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive "$@"; }
# Every file but what package managers and logs keep for themselves.
files() { (cd "$root" && find . -xdev \( -path ./proc -o -path ./var/lib/dpkg -o -path ./var/lib/apt -o -path ./var/cache -o -path ./var/log -o -path ./tmp \) -prune -o -print | sort); }

say "Package"
cmake --build "$build" -t package >"$build/package.log" || { cat "$build/package.log"; exit 1; }
deb=$(ls -t "$build"/regrasp_*.deb | head -1)
dpkg-deb --field "$deb" Package Version Architecture Installed-Size Depends

say "Fresh Debian 12 from $mirror"
debootstrap --variant=minbase bookworm "$root" "$mirror" >"$build/debootstrap.log" || { tail "$build/debootstrap.log"; exit 1; }
for file in /etc/apt/apt.conf.d/*proxy* /etc/apt/apt.conf; do [ -e "$file" ] && cp "$file" "$root/etc/apt/apt.conf.d/" || true; done
mount -t proc proc "$root/proc" 2>/dev/null || say "no /proc inside (not allowed here)"
inside apt-get -q -y -o Dpkg::Use-Pty=0 update >/dev/null
# What the package needs stays when it goes: install that first, so that the rest is the package's own.
cp "$deb" "$root/tmp/regrasp.deb"
inside apt-get -q -y -o Dpkg::Use-Pty=0 install --no-install-recommends $(dpkg-deb --field "$deb" Depends | sed 's/([^)]*)//g; s/|[^,]*//g; s/,/ /g') >/dev/null
files >"$build/files.before"

say "Install"
inside apt-get -q -y -o Dpkg::Use-Pty=0 install --no-install-recommends /tmp/regrasp.deb | grep -E '^(Setting up|E:|W:)' || true
files >"$build/files.installed"
comm -13 "$build/files.before" "$build/files.installed" | grep -v '/models/'
inside regrasp version
inside regraspd --version
say "Run"
inside regrasp doctor
inside regrasp up --speed max
inside regrasp grasp --wait
inside regrasp rotate --angle 90 --wait
inside regrasp plot gait -o /tmp/gait.png
inside regrasp down

say "Remove"
inside rm -rf /root/.local /tmp/regrasp-0 /run/regrasp
inside apt-get -q -y -o Dpkg::Use-Pty=0 purge regrasp | grep -E '^(Removing|Purging|dpkg: warning|E:|W:)' || true
files >"$build/files.after"
if ! diff "$build/files.before" "$build/files.after"; then
  say "FAILED: the package left something behind, or took something away"
  exit 1
fi
say "Installed, ran and was removed without a trace"
