# What apps/quickstart.sh, tests/run.sh and .ci/run share: the Debian packages, their installation, and the build with a
# preset. Source it from POSIX sh with the project's folder as the current one.
# shellcheck shell=sh disable=SC2034,SC2086  # lists are words to split

# Words of these lists are packages; a|b,c means a, or where the distribution has no a, both b and c.
pliant_packages="g++ cmake ninja-build libeigen3-dev libspectra-dev libsuitesparse-dev libopenblas0-serial|libopenblas0
nlohmann-json3-dev libcli11-dev libpng-dev libassimp-dev libosmesa6|libegl1,libgl1-mesa-dri"
# Tests need these too: both ways to draw without a screen, and an independent judge of the scenes' schema.
pliant_test_packages="catch2 pkgconf libegl1 libgl1-mesa-dri libvalijson-dev"

pliant_say() { printf '%s\n' "pliant: $*"; }

# Whether each package named is installed.
pliant_installed() {
  for installed_name; do
    case $(dpkg-query -W -f '${db:Status-Abbrev}' "$installed_name" 2>/dev/null) in
      ?i*) ;;
      *) return 1 ;;
    esac
  done
}

# Whether the distribution has a package to install by each name.
pliant_available() {
  for available_name; do
    apt-cache policy "$available_name" 2>/dev/null | grep -q '^  Candidate: [^(]' || return 1
  done
}

# Prints the packages that are missing, of the words of a list given as arguments.
pliant_missing() {
  for word; do
    wanted=
    for choice in $(printf '%s' "$word" | tr '|' ' '); do
      names=$(printf '%s' "$choice" | tr ',' ' ')
      if pliant_installed $names; then continue 2; fi
      if [ -z "$wanted" ] && pliant_available $names; then wanted=$names; fi
    done
    # Before the first look at the distribution's lists nothing is available: name the first choice.
    for name in ${wanted:-$(printf '%s' "${word%%|*}" | tr ',' ' ')}; do
      pliant_installed "$name" || printf '%s ' "$name"
    done
  done
}

# Installs what is missing of the packages every build needs and of the words given: as root, or through sudo. Otherwise
# it prints them and ends with status 4.
pliant_install() {
  if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
    pliant_say "not a Debian system: should configuring fail, install the counterparts of" $pliant_packages "$@"
    return 0
  fi
  missing=$(pliant_missing $pliant_packages "$@")
  [ -n "$missing" ] || return 0
  as_root=
  if [ "$(id -u)" -ne 0 ]; then
    if ! command -v sudo >/dev/null || { [ ! -t 0 ] && ! sudo -n true 2>/dev/null; }; then
      pliant_say "packages are missing, and installing them needs root or sudo: apt-get install $missing" >&2
      exit 4
    fi
    as_root=sudo
  fi
  apt="$as_root env DEBIAN_FRONTEND=noninteractive apt-get -q -o DPkg::Lock::Timeout=600"
  $apt update || pliant_say "the package lists could not be renewed; trying with the old ones"
  missing=$(pliant_missing $pliant_packages "$@")  # again: now it is known what the distribution has
  pliant_say "installing $missing"
  if ! $apt install -y --no-install-recommends $missing; then
    pliant_say "these packages could not be installed: $missing" >&2
    exit 4
  fi
}

# Compile jobs: one a processor, as far as memory goes (2 GB a job).
pliant_jobs() {
  jobs=$(nproc 2>/dev/null || echo 1)
  by_memory=$(awk '/^MemAvailable/ { print int($2 / 2000000) }' /proc/meminfo 2>/dev/null)
  if [ -n "$by_memory" ] && [ "$by_memory" -lt "$jobs" ]; then jobs=$by_memory; fi
  if [ "$jobs" -lt 1 ]; then jobs=1; fi
  echo "$jobs"
}

# pliant_configure PRESET [option...]: configures build/PRESET, with Ninja and ccache where they are installed.
pliant_configure() {
  preset=$1
  shift
  if [ ! -f "build/$preset/CMakeCache.txt" ]; then
    if command -v ninja >/dev/null; then set -- -G Ninja "$@"; fi
    if command -v ccache >/dev/null; then set -- -DCMAKE_CXX_COMPILER_LAUNCHER=ccache "$@"; fi
  fi
  cmake --preset "$preset" "$@"
}

# pliant_build PRESET [option...]: builds build/PRESET.
pliant_build() {
  preset=$1
  shift
  cmake --build "build/$preset" --parallel "$(pliant_jobs)" "$@"
}
