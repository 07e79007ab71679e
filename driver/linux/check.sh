#!/usr/bin/env bash
# The kernel's own check of style on what is written for a kernel: driver/linux/check.sh SOURCE,
# with kernel/build.sh's source of a kernel; the tests' own modules are looked at too. The core in
# driver/ is the project's C11, and looked after by its own format.
set -euo pipefail
(($# == 1)) || { printf 'hvp: expected: driver/linux/check.sh SOURCE\n' >&2 && exit 2; }
source=$(readlink -f -- "$1")
cd -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")"
exec perl "$source/scripts/checkpatch.pl" --strict --no-tree --terse --no-summary --file -- *.[ch] \
  ../../tests/driver/linux/*/*.c
