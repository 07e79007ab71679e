#!/usr/bin/env bash
# That tests/identical.sh notices what it is for, with programs that only write files.
#   tests/shell/identical_test.sh
# shellcheck disable=SC2016  # what the programs do is theirs to expand
set -euo pipefail
sources=$(dirname -- "$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
export HVP_JOBS=4

# A program that writes what `hvp` writes, and then does something of its own.
program() { # name; the rest of the script is on standard input
  {
    cat <<'P'
#!/usr/bin/env bash
command=$1
case $1 in
  run)
    mkdir result
    for file in summary.json frames.csv trace.json scenario.resolved.toml registers.log; do
      printf 'the first line\nthe second line\n' >"result/$file"
    done
    printf '%d\n' "$RANDOM" | tee result/performance.json result/latency.png >/dev/null
    printf 'PASS\nResults in result (2 s simulated in %d s)\n' "$RANDOM"
    ;;
  export)
    mkdir system
    echo 1 | tee system/K.mtx system/M.mtx system/b.mtx
    ;;
  solve)
    while [[ $1 != --solution ]]; do shift; done
    echo 1 | tee "$2"
    ;;
  *) echo "$1" | tee mesh.vtu ;;
esac
P
    cat
  } >"$scratch/$1"
  chmod +x "$scratch/$1"
}

failed=0
names=(thesis nos4 bean)
compare() { # what, the status that is expected, programs; then what has to be said, line by line
  local what=$1 expected=$2 status=0 said line
  local -a programs=("${@:3}") separator=(--)
  [[ $3 != --against ]] || separator=()
  said=$("$sources/tests/identical.sh" "${programs[@]/#--program=/$scratch/}" "${separator[@]}" "${names[@]}" 2>&1) || status=$?
  ((status == expected)) || { printf '%s: status %d\n%s\n' "$what" "$status" "$said" && failed=1; }
  while IFS= read -r line; do
    [[ $said == *"$line"* ]] || { printf '%s: "%s" is not in:\n%s\n' "$what" "$line" "$said" && failed=1; }
  done
}
against() { compare "$1" "$2" --against "--program=$3" "--program=$4"; }

program good <<<''
against 'the same' 0 good good <<<'0 problems: old new; 6 items'
program right <<<''
program fine <<<''
compare 'three builds' 0 --program=good --program=right --program=fine \
  <<<'0 problems: release elsewhere right fine; 6 items'

names=(thesis)
program digit <<<'[[ $command != run ]] || sed -i "2s/second/zweite/" result/frames.csv'
against 'a word in a line' 1 good digit <<'T'
run:thesis: result/frames.csv differs, old and new
  line 2
    old        the second line
    new        the zweite line
1 problems
T
compare 'one build alone' 1 --program=good --program=digit --program=right \
  <<<'run:thesis: result/frames.csv differs, release and digit'

program shorter <<<'[[ $command != run ]] || sed -i 2d result/frames.csv'
against 'an end too early' 1 good shorter <<<'  the one of new ends in line '

program sparing <<<'[[ $command != run ]] || rm result/registers.log'
against 'a file that one lacks' 1 good sparing \
  <<<'run:thesis: only one of old and new writes result/registers.log'
against 'a file that both lack' 1 sparing sparing <<<'run:thesis: there is no result/registers.log'

names=(nos4)
program failing <<<'[[ $command != solve ]] || { echo "no memory" >&2 && exit 3; }'
against 'both fail alike' 1 failing failing <<<'solve:nos4: plain ended with exit 3, old: no memory'

names=(thesis)
program late <<<'[[ $command != run ]] || exit 1'
against 'a budget that does not hold' 0 late late <<<'0 problems'
against 'a budget that holds no more' 1 good late <<<'run:thesis: run.status differs, old and new'

program printing <<<'[[ $command != explain ]] || echo more'
against 'what is printed' 1 good printing <<<'plan:thesis: explain.printed differs, old and new'

names=(bean)
program placed <<<'[[ $command != mesh ]] || echo "$PWD" >mesh.vtu'
compare 'the folder' 1 --program=placed --program=placed \
  <<<'mesh:bean: mesh.vtu differs, release and elsewhere'
program moody <<<'[[ $command != mesh ]] || echo "${TZ:-}${HVP_KERNEL:-}" >mesh.vtu'
compare 'the environment' 1 --program=moody --program=moody \
  <<<'mesh:bean: mesh.vtu differs, release and elsewhere'
exit "$failed"
