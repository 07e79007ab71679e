#!/usr/bin/env bash
# What cmake/build.sh and tests/run do about packages that come later, and about what is left out:
# with tools that only note that they were called, in a checkout of its own. And cmake/LeftOut.cmake.
#   tests/shell/configure_test.sh
set -euo pipefail
sources=$(dirname -- "$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
top=$scratch/checkout
mkdir -p "$top/cmake" "$top/tests" "$scratch/bin"
cp "$sources/cmake/build.sh" "$top/cmake"
cp "$sources/tests/run" "$top/tests"
cp "$sources/hvp" "$top"
printf '[run]\ncmake\n[test]\nverilator   # translates\n' >"$top/packages.txt"
touch -d '2020-01-01' "$top/packages.txt" "$top/CMakePresets.json"
unset HVP_BUILD_DIR
export HVP_JOBS=1 SCRATCH=$scratch

failed=0
expect() { # what, expected, found
  [[ $2 == "$3" ]] || { printf '%s: expected "%s", found "%s"\n' "$1" "$2" "$3" && failed=1; }
}
has() { # what, text, in
  [[ $3 == *"$2"* ]] || { printf '%s: "%s" is not in "%s"\n' "$1" "$2" "$3" && failed=1; }
}

mkdir "$scratch/project"
{
  printf 'cmake_minimum_required(VERSION 3.25)\nproject(x NONE)\n'
  printf 'include(%s/cmake/LeftOut.cmake)\n' "$sources"
  printf 'if(X)\nhvp_leave_out("the wheel" "no axle")\nhvp_leave_out("a" "b")\nendif()\nhvp_write_left_out()\n'
} >"$scratch/project/CMakeLists.txt"
said=$(cmake -S "$scratch/project" -B "$scratch/project/build" -DX=ON)
has 'CMake says it' 'left out: the wheel: no axle' "$said"
expect 'the list' $'the wheel: no axle\na: b' "$(<"$scratch/project/build/left-out.txt")"
cmake -S "$scratch/project" -B "$scratch/project/build" -DX=OFF >/dev/null
expect 'nothing is left out any more' '' "$(<"$scratch/project/build/left-out.txt")"

tool() { # name; the script is on standard input
  { printf '#!/usr/bin/env bash\n' && cat; } >"$scratch/bin/$1"
  chmod +x "$scratch/bin/$1"
}
export PATH=$scratch/bin:$PATH
tool dpkg-query <<'T'
cat "$SCRATCH/installed"
exit 1 # some are not there
T
tool cmake <<'T'
echo configured >>"$SCRATCH/calls"
while [[ $1 != -B ]]; do shift; done
touch "$2/build.ninja"
: >"$2/left-out.txt"
grep -q '^installed verilator' "$SCRATCH/installed" ||
  echo 'the RTL and its tests: verilator is not installed' >"$2/left-out.txt"
T
tool ninja <<<'echo "ninja: no work to do."'
tool ctest <<'T'
while [[ $1 != --test-dir ]]; do shift; done
mkdir -p "$2/Testing/Temporary"
printf '2/3 Test: Kernel.Fast\ncpp:7: Skipped\nthis processor is slow\n' >"$2/Testing/Temporary/LastTest.log"
printf '100%% tests passed, 0 tests failed out of 3\n\nThe following tests did not run:\n\t  2 - Kernel.Fast (Skipped)\n'
T

configured() { # how often, since the last time; what was said
  : >"$scratch/calls"
  said=$(
    # shellcheck source=cmake/build.sh
    source "$top/cmake/build.sh"
    mkdir -p "$build/release"
    configure release 2>&1
  )
  wc -l <"$scratch/calls"
}
packages() { printf 'installed %s\n' "$@" >"$scratch/installed"; }

packages 'cmake 3.25'
expect 'the first time' 1 "$(configured)"
expect 'nothing has changed' 0 "$(configured)"
packages 'cmake 3.25' 'verilator 5.006-1'
expect 'a package has arrived' 1 "$(configured)"
expect 'it is still there' 0 "$(configured)"
packages 'cmake 3.25' 'verilator 5.006-2'
expect 'a package has another version' 1 "$(configured)"
packages 'cmake 3.25'
printf 'deinstall verilator 5.006-2\n' >>"$scratch/installed"
expect 'a package has gone' 1 "$(configured)"
touch -d '1 minute' "$top/CMakePresets.json"  # Later than this moment's tick.
expect 'the presets have changed' 1 "$(configured)"

touch -d '2020-01-01' "$top/CMakePresets.json"
mkdir -p "$top/tests/vp/engine"
printf 'hvp_tested_size(n8 NodeBits 8)\n' >"$top/tests/vp/engine/rtl_sizes.cmake"
expect 'the sizes of the tests have changed' 1 "$(configured)"
expect 'they are the same' 0 "$(configured)"

# ./hvp rtl keeps the engine's size in the build, once, and not where it cannot be built.
sizes=$top/build/release/rtl-sizes.cmake
mkdir "$top/build/release/app"
cat >"$top/build/release/app/hvp" <<'T'
#!/usr/bin/env bash
[[ $2 == --cmake ]] || { echo "asked for $*" && exit; }
grep -qs n9 "$SCRATCH/checkout/build/release/rtl-sizes.cmake" || echo 'hvp_scenario_size(n9 NodeBits 9)'
T
chmod +x "$top/build/release/app/hvp"
expect 'the program has the last word' 'asked for rtl s.toml' "$("$top/hvp" rtl s.toml 2>/dev/null)"
expect 'a size is asked for' 'hvp_scenario_size(n9 NodeBits 9)' "$(<"$sizes")"
expect 'its build is configured' 0 "$(configured)"
"$top/hvp" rtl s.toml >/dev/null 2>&1
expect 'it is asked for again' 'hvp_scenario_size(n9 NodeBits 9)' "$(<"$sizes")"
printf 'hvp_scenario_size(n7 NodeBits 7)\n' >"$sizes"
expect 'the sizes have changed' 1 "$(configured)"
tool ninja <<<'exit 1'
status=0
"$top/hvp" rtl s.toml >/dev/null 2>&1 || status=$?
expect 'a size that cannot be built' '3 hvp_scenario_size(n7 NodeBits 7)' "$status $(<"$sizes")"
tool ninja <<<'echo "ninja: no work to do."'

rm -r "$top/build"
configured >/dev/null
has 'configuring says it' 'hvp: left out: the RTL and its tests: verilator is not installed' "$said"

answer=$("$top/tests/run" release 2>&1)
summary=${answer##*$'\n\n'}
has 'the count is of tests that ran' ' s, 2 tests' "$summary"
has 'a part that is left out' 'left out: the RTL and its tests: verilator is not installed' "$summary"
has 'a test that was skipped' 'left out: Kernel.Fast: this processor is slow' "$summary"
expect 'the last line' '3 passed, 0 failed' "${summary##*$'\n'}"
packages 'cmake 3.25' 'verilator 5.006-2'
answer=$("$top/tests/run" release 2>&1)
[[ $answer != *verilator* ]] || { printf 'verilator is there, and "%s"\n' "$answer" && failed=1; }
exit "$failed"
