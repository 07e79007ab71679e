#!/usr/bin/env bash
# The same input must give the same bytes whatever the compiler, the build type, the directory, the
# environment and the kernel: every result file of every scenario but the pictures and
# performance.json, and what the other commands print and write. Every scenario runs whole, so that
# all that it has is reached: 1000 frames take a Debug build 10 s, and two programs run at once. A
# difference names what was run, the file and its first line that differs.
#   tests/identical.sh RELEASE OTHER… [-- NAME…]     builds of the program: `./hvp test identical`
#   tests/identical.sh --against OLD NEW [NAME…]     the program before a change, and after it
# With names, the scenarios, surfaces and matrices that are called so. HVP_JOBS is how many run at
# once, by default as many as there are processors.
set -euo pipefail
top=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
scratch=$(mktemp -d)
trap 'kill $(jobs -p) 2>/dev/null || true; rm -rf "$scratch"' EXIT
export LC_ALL=C

usage() {
  sed -n '2,/^set/s/^# \{0,1\}//p' "${BASH_SOURCE[0]}" >&2
  exit 2
}

# Each variant has a program and a folder of its own, whose depth differs too, with a copy of the
# input. The first is what the others are compared with.
declare -A program=() folder=() environment=()
variants=()
variant() { # name, program, folder, environment…
  [[ -x $2 ]] || { printf 'there is no program %s\n' "$2" >&2 && exit 2; }
  variants+=("$1")
  program[$1]=$(readlink -f -- "$2") folder[$1]=$scratch/$3 environment[$1]=${*:4}
  mkdir -p "$scratch/$3/out"
  cp -r "$top/scenarios" "$top/tests/data/matrix_market" "$scratch/$3"
}
names=()
if [[ ${1:-} == --against ]]; then
  (($# >= 3)) || usage
  variant old "$2" old
  variant new "$3" new
  names=("${@:4}")
elif [[ $# -ge 2 && $1 != -* && $2 != -* ]]; then
  variant release "$1" release
  variant elsewhere "$1" somewhere/else TZ=Asia/Kolkata OMP_NUM_THREADS=1 HVP_KERNEL=portable
  shift
  while (($# > 0)); do
    if [[ $1 == -- ]]; then
      names=("${@:2}")
      break
    fi
    # build/clang/app/hvp is called clang.
    other=${1%/app/hvp} other=${other##*/}
    variant "$other" "$1" "another/build/$other"
    shift
  done
else
  usage
fi

# One command: what it printed, in two files, and how it ended, in the folder of its item.
hvp() { # name, arguments…
  local name=$1 status=0
  env "${settings[@]}" "$hvp" "${@:2}" >"$name.printed" 2>"$name.errors" || status=$?
  printf 'exit %d\n' "$status" >"$name.status"
}

# What is compared: items, each a function and what it is about.
items=()
add() { # functions, files
  local function file name
  for file in "${@:2}"; do
    name=$(basename "${file%.*}")
    [[ ${#names[@]} == 0 || " ${names[*]} " == *" $name "* ]] || continue
    for function in $1; do items+=("$function:$name"); done
  done
}
for scenario in "$top"/scenarios/*.toml; do
  # A wall has neither an accelerator nor a matrix.
  if grep -q '^\[wall\]' "$scenario"; then add 'run loop' "$scenario"; else add 'run plan' "$scenario"; fi
done
add mesh "$top"/scenarios/surfaces/*.stl
add solve "$top"/tests/data/matrix_market/*.mtx
((${#items[@]})) || { printf 'nothing is called %s\n' "${names[*]}" >&2 && exit 2; }

run() {
  hvp run run "../../scenarios/$1.toml" --quiet --trace-registers --details --out result \
    --set output.pictures=false --set output.remedies=false
  # The last line has the time that it took.
  sed -i '/^Results in /d' run.printed
}

plan() {
  hvp explain explain "../../scenarios/$1.toml"
  hvp device device "../../scenarios/$1.toml"
  hvp json device "../../scenarios/$1.toml" --json
  hvp export export "../../scenarios/$1.toml" --set loads.gravity=true --out system
  hvp solve solve --matrix system/K.mtx --rhs system/b.mtx --solution x.mtx
}

loop() {
  hvp explain explain "../../scenarios/$1.toml"
  hvp stability stability "../../scenarios/$1.toml" --json
}

mesh() { hvp mesh mesh "../../scenarios/surfaces/$1.stl" --nodes 500 --out mesh.vtu; }

solve() {
  local matrix=../../matrix_market/$1.mtx rows
  rows=$(awk '!/^%/ { print $1; exit }' "$matrix")
  { printf '%%%%MatrixMarket matrix array real general\n%d 1\n' "$rows" && seq "$rows"; } >b.mtx
  hvp plain solve --matrix "$matrix" --rhs b.mtx --solution plain.mtx
  hvp refined solve --matrix "$matrix" --rhs b.mtx --solution refined.mtx --set spectrum=true \
    --set solver.matrix_scaling=diagonal --set refinement.passes=4
}

work() { # variant, item
  local -a settings
  local hvp=${program[$1]} place=${folder[$1]}/out/${2/:/-}
  read -ra settings <<<"${environment[$1]}"
  mkdir "$place" && cd "$place" && "${2%%:*}" "${2#*:}" && : >"$place.done"
}

started=$SECONDS jobs=${HVP_JOBS:-$(nproc)}
for item in "${items[@]}"; do
  for variant in "${variants[@]}"; do
    while (($(jobs -rp | wc -l) >= jobs)); do wait -n || true; done
    work "$variant" "$item" &
  done
done
wait

problems=0
problem() {
  problems=$((problems + 1))
  printf '%s\n' "$*"
}

# Of two lines, from a little before the first character in which they differ.
show() { # label, line, the other
  local same=0 beyond=${#2} middle
  while ((same < beyond)); do
    middle=$(((same + beyond + 1) / 2))
    if [[ ${2:0:middle} == "${3:0:middle}" ]]; then same=$middle; else beyond=$((middle - 1)); fi
  done
  local from=$((same > 60 ? same - 60 : 0))
  printf '    %-10s %s\n' "$1" "$(printf '%s' "${2:from:120}" | tr -c '[:print:]' '?')"
}

# The file's first line that differs, as both have it.
first_difference() { # variant, its file, another, its file
  local found line one other
  found=$(cmp "$2" "$4" 2>&1 || true)
  line=$(grep -oE 'line [0-9]+' <<<"$found")
  line=${line#line }
  if [[ $found == *EOF* ]]; then
    [[ $found == *"EOF on $2 "* ]] && one=$1 || one=$3
    printf '  the one of %s ends in line %d, the other goes on\n' "$one" "$line"
    return
  fi
  one=$(sed -n "${line}p" "$2" | tr -d '\0') other=$(sed -n "${line}p" "$4" | tr -d '\0')
  printf '  line %d\n' "$line"
  show "$1" "$one" "$other"
  show "$3" "$other" "$one"
}

compared=0
compare() { # item, variant, another
  local -a results=(-type f ! -name '*.png' ! -name performance.json)
  local one=${folder[$2]}/out/${1/:/-} other=${folder[$3]}/out/${1/:/-} file different=0
  while IFS= read -r -d '' file; do
    compared=$((compared + 1))
    ! cmp -s "$one/$file" "$other/$file" || continue
    different=$((different + 1))
    ((different <= 3)) || continue
    if [[ ! -f $one/$file || ! -f $other/$file ]]; then
      problem "$1: only one of $2 and $3 writes $file"
    else
      problem "$1: $file differs, $2 and $3"
      first_difference "$2" "$one/$file" "$3" "$other/$file"
    fi
  done < <( # the many steps of a deformation last
    find "$one" "$other" "${results[@]}" ! -name '*.vtu' -printf '%P\0' | sort -zu
    find "$one" "$other" "${results[@]}" -name '*.vtu' -printf '%P\0' | sort -zu
  )
  ((different <= 3)) || printf '  and %d more files of %s\n' "$((different - 3))" "$1"
}

boardless() { # place, command
  [[ $2 == @(device|json) ]] && grep -q 'host.solver: no board is built' "$1/$2.errors"
}

# That nothing came of an item, in all variants alike, must not pass.
demand() { # item, files…
  local file place=${folder[${variants[0]}]}/out/${1/:/-}
  for file in "${@:2}"; do
    [[ -s $place/$file ]] || problem "$1: there is no $file"
  done
}

for item in "${items[@]}"; do
  for variant in "${variants[@]}"; do
    place=${folder[$variant]}/out/${item/:/-}
    [[ -f $place.done ]] || problem "$item: the commands did not come to an end with $variant"
    # 1 says that a budget did not hold: still a result. So is that a scenario without a board has no device.
    while IFS= read -r -d '' file; do
      [[ $(<"$file") == 'exit '[01] ]] || boardless "${file%/*}" "$(basename "$file" .status)" ||
        problem "$item: $(basename "$file" .status) ended with $(<"$file"), $variant: $(tail -n 1 "${file%.status}.errors")"
    done < <(find "$place" -maxdepth 1 -name '*.status' -print0)
    [[ $variant == "${variants[0]}" ]] || compare "$item" "${variants[0]}" "$variant"
  done
  case $item in
    run:*)
      demand "$item" run.printed \
        result/{summary.json,frames.csv,trace.json,scenario.resolved.toml,registers.log}
      ! grep -q '"output.waveform"' "${folder[${variants[0]}]}/out/${item/:/-}/result/summary.json" ||
        demand "$item" result/engine.vcd
      ;;
    plan:*)
      demand "$item" {explain,solve}.printed system/{K,M,b}.mtx x.mtx
      boardless "${folder[${variants[0]}]}/out/${item/:/-}" device || demand "$item" {device,json}.printed
      ;;
    mesh:*) demand "$item" mesh.printed mesh.vtu ;;
    solve:*) demand "$item" {plain,refined}.{printed,mtx} ;;
  esac
done
printf '%d comparisons of files, %d problems: %s; %d items, %d s\n' \
  "$compared" "$problems" "${variants[*]}" "${#items[@]}" "$((SECONDS - started))"
((problems == 0))
