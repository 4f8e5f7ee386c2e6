# shellcheck shell=bash
# Shared by ./demo, ./check and .ci/run: sourced, not run. Needs bash with `set -euo pipefail`.
# Asks nothing: standard input is closed off, apt-get runs non-interactively.

root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
build=$root/build/release
exec 0</dev/null

say() { printf '\n== %s\n' "$*"; }

# packages_of SECTION...: the names in those sections of packages.txt.
packages_of() {
  local wanted=" $* " section="" line
  while IFS= read -r line || [ -n "$line" ]; do
    line=${line%%#*}
    line=${line//[[:space:]]/}
    case $line in
      "") ;;
      "["*"]") section=${line:1:-1} ;;
      *) case $wanted in *" $section "*) printf '%s\n' "$line" ;; esac ;;
    esac
  done <"$root/packages.txt"
}

# install_packages SECTION...: installs what is missing, and says what.
install_packages() {
  local missing=() name
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    echo "This script installs Debian packages and finds no apt-get here. packages.txt lists what is needed." >&2
    return 1
  fi
  for name in $(packages_of "$@"); do
    case $(dpkg-query -W -f '${db:Status-Abbrev}' "$name" 2>/dev/null || true) in
      ii*) ;;
      *) missing+=("$name") ;;
    esac
  done
  if [ ${#missing[@]} -eq 0 ]; then
    say "Debian packages: all there ($* of packages.txt)"
    return 0
  fi
  say "Installing Debian packages: ${missing[*]}"
  local apt=(env DEBIAN_FRONTEND=noninteractive apt-get -q -y -o DPkg::Lock::Timeout=300)
  if [ "$(id -u)" -ne 0 ]; then
    command -v sudo >/dev/null || { echo "Not root and no sudo: install them and run this again." >&2; return 1; }
    apt=(sudo "${apt[@]}")
  fi
  "${apt[@]}" update
  "${apt[@]}" install --no-install-recommends "${missing[@]}"
}

# build_release ON|OFF: configures and builds the release preset, with or without tests and benchmarks.
build_release() {
  local options=(-DREGRASP_BUILD_TESTS="$1" -DREGRASP_BUILD_BENCH="$1")
  if command -v ccache >/dev/null; then
    options+=(-DCMAKE_CXX_COMPILER_LAUNCHER=ccache)
    # Without a usable home the cache goes into the build directory.
    if [ -z "${CCACHE_DIR:-}" ] && ! { [ -n "${HOME:-}" ] && mkdir -p "$HOME/.cache" 2>/dev/null; }; then
      export CCACHE_DIR=$root/build/ccache
    fi
  fi
  say "Building (release, $(nproc) cores) in ${build#"$root"/}"
  mkdir -p "$build"
  (cd "$root" && cmake --preset release "${options[@]}") >"$build/configure.log" 2>&1 || {
    cat "$build/configure.log" >&2
    return 1
  }
  cmake --build "$build" -j "$(nproc)"
}
