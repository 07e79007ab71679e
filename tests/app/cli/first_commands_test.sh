#!/usr/bin/env bash
# hvp-run, which ./hvp builds for a first run, has the commands that ./hvp gives it, takes what hvp
# takes and writes what hvp writes.
#   first_commands_test.sh HVP HVP_RUN
set -euo pipefail
top=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")/../../..
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failed=0
differ() { printf '%s\n' "$1" && failed=1; }

given=$(sed -n "s/^first_commands=' \(.*\) '$/\1/p" "$top/hvp")
[[ -n $given ]] || differ 'hvp: no line first_commands='
commands=$("$2" --help | sed -n '/^Subcommands:$/,/^$/s/^  \([a-z]*\) .*/\1/p' | paste -sd ' ')
[[ $commands == "$given" ]] || differ "hvp-run has '$commands', hvp sends it '$given'"
for command in $given; do
  diff <("$1" "$command" --help) <("$2" "$command" --help) || differ "$command --help"
done
for program in "$1" "$2"; do
  name=${program##*/}
  "$program" run "$top/scenarios/sphere-in-hand.toml" --quiet --set output.pictures=false \
    --set frames=20 --out "$scratch/$name" >"$scratch/$name.out" || true
  # What the simulation took of the machine's time is no result.
  sed -i "s#$scratch/$name#OUT#g; s# in [0-9.]* s, [0-9]* frames a second##" "$scratch/$name.out"
done
rm -f "$scratch"/*/performance.json
diff -r "$scratch/hvp" "$scratch/hvp-run" || differ 'run: its results'
diff "$scratch/hvp.out" "$scratch/hvp-run.out" || differ 'run: what it prints'
[[ -s $scratch/hvp-run/summary.json ]] || differ 'run: no results'
exit "$failed"
