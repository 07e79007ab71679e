#!/usr/bin/env bash
# The same scenario must give the same bytes in every result file but the pictures and
# performance.json, whatever the compiler, the build type, the directory and the environment.
#   tests/identical.sh RELEASE DEBUG CLANG      three builds of the program
set -euo pipefail
release=$1 debug=$2 clang=$3
top=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

run() { # name, program: each in a directory of its own, whose depth differs too
  local directory=$scratch/$1/$1
  mkdir -p "$directory"
  (cd "$directory" && "$2" run "$top/scenarios/thesis.toml" --quiet --set frames=300 --out result \
    --set output.pictures=false >/dev/null) ||
    (($? == 1)) # 1 says that a budget did not hold: still a result
}

run first "$release"
TZ=Asia/Kolkata OMP_NUM_THREADS=1 run second/time "$release"
run debug "$debug"
run clang "$clang"

compared=0
for other in second/time debug clang; do
  diff --recursive --brief --exclude='*.png' --exclude=performance.json \
    "$scratch/first/first/result" "$scratch/$other/$other/result"
  compared=$((compared + 1))
done
files=$(find "$scratch/first/first/result" -type f ! -name '*.png' ! -name performance.json | wc -l)
((files >= 4)) || { printf 'only %d result files to compare\n' "$files" && exit 1; }
printf '%d files are the same in %d more runs\n' "$files" "$compared"
