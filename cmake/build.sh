# Sourced by `hvp` and `tests/run`: installs Debian packages, configures and builds one preset.
# Needs $top (the checkout). Sets $build (where build directories go) and $HVP_JOBS. Everything it
# prints goes to stderr: stdout belongs to the program.
# shellcheck shell=bash

build=${HVP_BUILD_DIR:-$top/build}
[[ $build == /* ]] || build=$PWD/$build

say() { printf 'hvp: %s\n' "$*" >&2; }
fail() {
  say "$*"
  exit 3
}

# A compilation with VTK's and SystemC's headers under the sanitizers peaks near 1.5 GB.
set_jobs() {
  [[ -z ${HVP_JOBS:-} ]] || return 0
  local name kilobytes rest
  HVP_JOBS=$(nproc)
  while read -r name kilobytes rest; do
    [[ $name == MemAvailable: ]] || continue
    local fitting=$((kilobytes / 1500000))
    ((fitting >= 1)) || fitting=1
    ((fitting >= HVP_JOBS)) || HVP_JOBS=$fitting
  done </proc/meminfo
}

# The packages of the given sections of packages.txt, or of all of them.
packages() { # sections…
  local section='' name rest
  while read -r name rest; do
    case $name in
      '' | \#*) ;;
      \[*\]) section=${name:1:-1} ;;
      *) [[ $# != 0 && " $* " != *" $section "* ]] || printf '%s\n' "$name" ;;
    esac
  done <"$top/packages.txt"
}

# Name and version of those that are installed, in order; nothing where there is no dpkg.
installed_packages() { # sections…
  local -a wanted
  mapfile -t wanted < <(packages "$@")
  { dpkg-query -W -f='${db:Status-Status} ${Package} ${Version}\n' "${wanted[@]}" 2>/dev/null || true; } |
    sed -n 's/^installed //p' | LC_ALL=C sort
}

missing_packages() { # sections…
  local name rest
  local -A installed=()
  while read -r name rest; do installed[$name]=yes; done < <(installed_packages "$@")
  while read -r name; do
    [[ -n ${installed[$name]:-} ]] || printf '%s ' "$name"
  done < <(packages "$@")
}

# Turns apt-get's hundreds of lines into one that counts (on a terminal) or into ten.
apt_progress() {
  local line total=0 fetched=0 set_up=0 shown=-1 tenth
  while read -r line; do
    case $line in
      *' newly installed,'*)
        line=${line%% newly installed*}
        total=${line##* }
        fetched=0
        ;;
      Get:*) fetched=$((fetched + 1)) ;;
      'Setting up '*) set_up=$((set_up + 1)) ;;
      E:* | W:*) printf '%s\n' "$line" >&2 ;;
    esac
    ((total > 0)) || continue
    if [[ -t 2 ]]; then
      printf '\rhvp: %d packages: %d fetched, %d set up ' "$total" "$fetched" "$set_up" >&2
    else
      tenth=$(((fetched + set_up) * 5 / total))
      ((tenth == shown)) || say "$total packages: $fetched fetched, $set_up set up"
      shown=$tenth
    fi
  done
  [[ ! -t 2 ]] || ((total == 0)) || printf '\n' >&2
}

apt_get() {
  local -a as_root=(env DEBIAN_FRONTEND=noninteractive)
  [[ $(id -u) == 0 ]] || as_root=(sudo "${as_root[@]}")
  # Another apt, for instance of a second terminal, is waited for.
  "${as_root[@]}" apt-get -q -o DPkg::Lock::Timeout=600 -o Acquire::Retries=3 "$@" </dev/null
}

install_packages() { # sections
  if ! command -v dpkg-query >/dev/null; then
    missing_a_package_manager=yes
    return 0
  fi
  local missing manual section
  local -a required=()
  missing=$(missing_packages "$@")
  [[ -n $missing ]] || return 0
  manual="apt-get install -y --no-install-recommends $missing"
  command -v apt-get >/dev/null || fail "install these packages, then try again: $missing"
  if [[ $(id -u) != 0 ]] && ! sudo -n true 2>/dev/null &&
    ! { command -v sudo >/dev/null && [[ -t 0 ]]; }; then
    for section in "$@"; do [[ $section == pictures ]] || required+=("$section"); done
    if [[ -z $(missing_packages "${required[@]}") ]]; then
      say "without a display there will be no pictures. For them, run as root: $manual"
      return 0
    fi
    fail "packages are missing, and installing them takes root. Run as root: $manual"
  fi
  say "installing Debian packages: $missing"
  [[ $(id -u) == 0 ]] || sudo -v || fail "sudo refused. Run as root: $manual"
  if ! compgen -G '/var/lib/apt/lists/*_Packages*' >/dev/null; then
    apt_get update | apt_progress || fail "apt-get update failed; the lines above say why"
  fi
  # shellcheck disable=SC2086  # a list of names
  apt_get install -y --no-install-recommends $missing | apt_progress || {
    say "that failed; once more with fresh package lists"
    { apt_get update && apt_get install -y --no-install-recommends $missing; } | apt_progress ||
      fail "the packages could not be installed. Try: apt-get update && $manual"
  }
}

# Runs a command while no other hvp works in that directory.
locked() { # directory command…
  (
    flock --nonblock 9 || {
      say "another hvp works in $1; waiting for it"
      flock 9
    }
    "${@:2}"
  ) 9>"$1/.hvp-lock"
}

# What configuring found: where the build directory belongs, as a checkout that was moved or copied
# must not build from the old place, which CMake's cache remembers; and the packages, as what was
# not there then is left out; the engine's modules, as ninja translates them once more before
# it looks for new ones; and the engine's sizes that were asked for, and that the tests have.
configured_for() { # preset
  printf '%s\n' "$top" "$build/$1"
  (cd "$top" && printf '%s\n' vp/fpga/rtl/*.sv vp/fpga/rtl/engine/*.sv)
  local sizes
  for sizes in "$build/$1/rtl-sizes.cmake" "$top/tests/vp/engine/rtl_sizes.cmake"; do
    [[ ! -f $sizes ]] || cat "$sizes"
  done
  installed_packages
}

is_configured() { # preset
  local dir=$build/$1
  [[ -f $dir/build.ninja && -f $dir/.hvp-configured ]] &&
    [[ $(<"$dir/.hvp-configured") == "$(configured_for "$1")" ]] &&
    [[ ! $top/CMakePresets.json -nt $dir/.hvp-configured ]] &&
    [[ ! $top/packages.txt -nt $dir/.hvp-configured ]]
}

# Whether nothing is to be done, without taking the lock.
is_up_to_date() { # preset target…
  is_configured "$1" && [[ $(ninja -C "$build/$1" -n "${@:2}" 2>&1) == *'ninja: no work to do.' ]]
}

configure() { # preset
  local dir=$build/$1 line
  ! is_configured "$1" || return 0
  say "configuring $dir"
  rm -f "$dir/.hvp-configured"
  cmake -S "$top" --preset "$1" -B "$dir" --fresh >"$dir/configure.log" 2>&1 || {
    cat "$dir/configure.log" >&2
    [[ -z ${missing_a_package_manager:-} ]] ||
      say "this is not Debian: install what packages.txt lists under [run] with your system's tools"
    return 1
  }
  configured_for "$1" >"$dir/.hvp-configured"
  while IFS= read -r line; do say "$line"; done < <(left_out "$1")
}

# What the configuration leaves out, and why: a line each (cmake/LeftOut.cmake).
left_out() { # preset
  local line
  [[ -f $build/$1/left-out.txt ]] || return 0
  while IFS= read -r line; do printf 'left out: %s\n' "$line"; done <"$build/$1/left-out.txt"
}

configure_and_build() { # preset target…
  configure "$1" || return 1
  ! is_up_to_date "$@" || return 0
  say "building $build/$1 with $HVP_JOBS jobs"
  NINJA_STATUS='[%f/%t %es] ' ninja -C "$build/$1" -j "$HVP_JOBS" "${@:2}" >&2
}

# Brings targets of a preset up to date, or returns 1.
build() { # preset target…
  mkdir -p "$build/$1" 2>/dev/null || true
  [[ -w $build/$1 ]] ||
    fail "cannot write to $build/$1; set HVP_BUILD_DIR to a directory for the builds"
  set_jobs
  # A home that cannot be written must not stop the compiler.
  [[ -n ${CCACHE_DIR:-} || -w ${HOME:-/nonexistent} ]] || export CCACHE_DIR=$build/ccache
  # What another checkout of the same files has compiled serves this one.
  export CCACHE_BASEDIR=$top CCACHE_NOHASHDIR=1
  locked "$build/$1" configure_and_build "$@"
}

# A virtual environment $build/NAME with what the files list, made where it is missing or they have
# changed. Only whole ones get a stamp.
make_python_environment() { # name requirements…
  local folder=$build/$1 listed=$build/$1-requirements file
  local -a options=()
  for file in "${@:2}"; do options+=(-r "$file"); done
  cat "${@:2}" >"$listed"
  ! cmp -s "$listed" "$folder/requirements" || return 0
  say "making a virtual environment with the Python packages of ${*:2}: $folder"
  rm -rf "$folder"
  if python3 -m venv "$folder" >&2 &&
    "$folder/bin/pip" --quiet --disable-pip-version-check install "${options[@]}" >&2; then
    cp "$listed" "$folder/requirements"
  else
    rm -rf "$folder"
    return 1
  fi
}

# The same; waits for another hvp, and ends the program where it fails.
python_environment() { # name requirements…
  mkdir -p "$build" 2>/dev/null || true
  [[ -w $build ]] || fail "cannot write to $build; set HVP_BUILD_DIR to a directory for the builds"
  # A finished one is taken without waiting.
  ! cat "${@:2}" | cmp -s - "$build/$1/requirements" || return 0
  locked "$build" make_python_environment "$@" ||
    fail "the Python packages could not be installed; the lines above say why"
}

# What `hvp linux` boots: build/linux/VARIANT (driver/linux/kernel/build.sh).
build_guest() { # variant
  build release hvp hvp-fault hvp-servo hvp-driver-suite hvp-stress || return 1
  "$top/driver/linux/guest.sh" "$build/linux" "$1" \
    "$build/release/driver/linux/guest/hvp-fault" \
    "$build/release/driver/linux/guest/hvp-servo" \
    "$build/release/tests/driver/suite/hvp-driver-suite" \
    "$build/release/tests/linux/stress/hvp-stress" >&2
}

# What tables/driver_layers.py runs: the suite of the driver's tests, the board in two processes, the
# guest, and in that a way to the registers beside the driver.
build_driver_layers() {
  build release driver_suite_in_process driver_suite_over_socket || return 1
  build_guest plain || return 1
  "$top/driver/linux/build.sh" "$build/linux/plain/tree" "$build/linux/plain/registers" \
    "$top/tests/driver/linux/registers" >&2
}
