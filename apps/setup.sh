# Functions for apps/quickstart.sh, tests/run.sh and .ci/run: the lists of Debian packages, their installation, and the
# build with a preset of CMake. Source this file from POSIX sh in the folder of the project.
# shellcheck shell=sh disable=SC2034,SC2046,SC2086  # lists are words to split

# Durations on 2 cores in a new folder, in minutes. README.md states the first duration. README.md and tests/README.md state
# the sum of the second and the third.
pliant_minutes_program="4 to 7"
pliant_minutes_everything="9 to 15"
pliant_minutes_tests=20

# Each word of these lists is a package or a choice. The choice a|b,c means package a, or both b and c if the distribution
# has no package a.
pliant_packages="cmake ninja-build libeigen3-dev libspectra-dev libsuitesparse-dev libopenblas0-serial|libopenblas0
nlohmann-json3-dev libcli11-dev libpng-dev zlib1g-dev libassimp-dev libosmesa6|libegl1,libgl1-mesa-dri"
# The window of `pliant view` needs these packages; without them the program is built without a window.
pliant_window_packages="libglfw3-dev libimgui-dev"
# Tests also need GCC for the clients of the library, both libraries that draw without a screen, an independent validator of
# the scenes' schema, Python for the tests that are Python scripts, and a virtual display with synthetic inputs for tests of
# the window.
pliant_test_packages="g++ catch2 pkgconf python3 libegl1 libgl1-mesa-dri libvalijson-dev $pliant_window_packages xvfb xdotool"

pliant_say() { printf '%s\n' "pliant: $*"; }

# pliant_begin STAGE EXPECTATION: prints the stage and its expected duration; pliant_end prints the actual duration.
pliant_begin() {
  pliant_stage=$1
  pliant_stage_start=$(date +%s)
  pliant_say "$1: $2"
}
pliant_end() {
  pliant_seconds=$(($(date +%s) - pliant_stage_start))
  if [ "$pliant_seconds" -lt 120 ]; then
    pliant_say "$pliant_stage: took $pliant_seconds s"
  else
    pliant_say "$pliant_stage: took $((pliant_seconds / 60)) min $((pliant_seconds % 60)) s"
  fi
}

# pliant_installed PACKAGE...: returns status 0 if all packages are installed.
pliant_installed() {
  for installed_name; do
    case $(dpkg-query -W -f '${db:Status-Abbrev}' "$installed_name" 2>/dev/null) in
      ?i*) ;;
      *) return 1 ;;
    esac
  done
}

# pliant_available PACKAGE...: returns status 0 if the distribution has all packages.
pliant_available() {
  for available_name; do
    apt-cache policy "$available_name" 2>/dev/null | grep -q '^  Candidate: [^(]' || return 1
  done
}

# pliant_missing WORD...: prints the missing packages of a list with these words.
pliant_missing() {
  for word; do
    wanted=
    for choice in $(printf '%s' "$word" | tr '|' ' '); do
      names=$(printf '%s' "$choice" | tr ',' ' ')
      if pliant_installed $names; then continue 2; fi
      if [ -z "$wanted" ] && pliant_available $names; then wanted=$names; fi
    done
    # Before apt has read its package lists, no package is available. Then print the first choice.
    for name in ${wanted:-$(printf '%s' "${word%%|*}" | tr ',' ' ')}; do
      pliant_installed "$name" || printf '%s ' "$name"
    done
  done
}

# pliant_can_install: returns status 0 as root, or if sudo may be used.
pliant_can_install() {
  [ "$(id -u)" -eq 0 ] || { command -v sudo >/dev/null && { [ -t 0 ] || sudo -n true 2>/dev/null; }; }
}

# pliant_compiler: prints the package of the compiler, as a word of a list, or nothing if CXX names an installed compiler.
# Without root and sudo, an installed g++ is sufficient.
pliant_compiler() {
  if [ -n "${CXX:-}" ]; then return; fi
  if pliant_can_install; then echo clang; else echo "clang|g++"; fi
}

# pliant_install WORD...: installs, as root or through sudo, the missing packages of the compiler, of pliant_packages and of
# the words. If the installation is impossible, prints the names of the missing packages and ends the script with status 4.
# On systems without dpkg-query or apt-get, only prints the names of all packages.
pliant_install() {
  set -- $(pliant_compiler) $pliant_packages "$@"
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    pliant_say "this is not a Debian system; if configuring fails, install the counterparts of" "$@"
    return 0
  fi
  missing=$(pliant_missing "$@")
  [ -n "$missing" ] || return 0
  if ! pliant_can_install; then
    pliant_say "packages are missing, and their installation needs root or sudo: apt-get install $missing" >&2
    exit 4
  fi
  as_root=
  if [ "$(id -u)" -ne 0 ]; then as_root=sudo; fi
  apt="$as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=600"
  pliant_begin "packages" "installing $missing; the time depends on the network"
  $apt update || pliant_say "the package lists could not be updated; continuing with the old ones"
  missing=$(pliant_missing "$@")  # again, with the updated lists
  if ! $apt install -y --no-install-recommends $missing; then
    pliant_say "these packages could not be installed: $missing" >&2
    exit 4
  fi
  pliant_end
}

# pliant_jobs: prints the number of compile jobs: one for each processor, at most one for each 2.5 GB of available memory,
# and at least one.
pliant_jobs() {
  jobs=$(nproc 2>/dev/null || echo 1)
  by_memory=$(awk '/^MemAvailable/ { print int($2 / 2500000) }' /proc/meminfo 2>/dev/null)
  if [ -n "$by_memory" ] && [ "$by_memory" -lt "$jobs" ]; then jobs=$by_memory; fi
  if [ "$jobs" -lt 1 ]; then jobs=1; fi
  echo "$jobs"
}

# pliant_configure PRESET [option...]: configures build/PRESET. A new folder uses the compiler CXX if this variable is set,
# or else Clang if it is installed, because Clang needs two thirds of the time of GCC. Ninja and ccache are used if installed.
# ccache does not store objects that use precompiled headers, so a build with ccache uses no precompiled headers.
pliant_configure() {
  preset=$1
  shift
  if [ ! -f "build/$preset/CMakeCache.txt" ]; then
    if [ -z "${CXX:-}" ] && command -v clang++ >/dev/null; then set -- -DCMAKE_CXX_COMPILER=clang++ "$@"; fi
    if command -v ninja >/dev/null; then set -- -G Ninja "$@"; fi
    if command -v ccache >/dev/null; then
      set -- -DCMAKE_CXX_COMPILER_LAUNCHER=ccache -DCMAKE_DISABLE_PRECOMPILE_HEADERS=ON "$@"
    fi
  fi
  cmake --preset "$preset" "$@"
}

# pliant_build PRESET [option...]: builds build/PRESET. Each line of Ninja begins with the elapsed time, because the compile
# times of files differ greatly.
pliant_build() {
  preset=$1
  shift
  NINJA_STATUS="${NINJA_STATUS-[%e s, %f of %t steps] }" cmake --build "build/$preset" --parallel "$(pliant_jobs)" "$@"
}
