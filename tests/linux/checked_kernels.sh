#!/usr/bin/env bash
# The module's life, and simulated minutes of stress, in a kernel that looks for what others do not
# notice, with KASAN and lockdep; and that it finds it: a module with a buffer that is too short.
#   tests/linux/checked_kernels.sh BUILD FOLDER PROGRAM…
# BUILD is a folder of the preset release, FOLDER has the kernel (driver/linux/guest.sh), which takes
# some minutes to build the first time. PROGRAM: what goes into the initramfs.
set -euo pipefail
here=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")
top=$(dirname -- "$(dirname -- "$here")")
(($# >= 3)) || { printf 'expected: checked_kernels.sh BUILD FOLDER PROGRAM…\n' >&2 && exit 2; }
hvp=$1/app/hvp
kernels=$2
programs=("${@:3}")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

variant=kasan+lockdep
boot() { # kernel initramfs script
  timeout 600 "$hvp" linux "$top/scenarios/thesis-static.toml" --quiet --patience 120 \
    --set transfer.method=dma --set transfer.notification=msi --check kasan,lockdep \
    --kernel "$1" --initrd "$2" --script "$3" --out "$work/out" >"$work/said" 2>&1
}
give_up() { # why
  tail -n 40 "$work/out/console.log" "$work/said"
  printf 'FAILED: %s\n' "$1"
  exit 1
}

"$top/driver/linux/guest.sh" "$kernels" "$variant" "${programs[@]}"
# Status 1 says that a frame was late: some of the suite's cases wait for what never comes.
status=0
boot "$kernels/$variant/linux" "$kernels/$variant/initramfs.cpio.gz" \
  "$top/tests/driver/linux/lifecycle.sh" || status=$?
((status <= 1)) || give_up "$variant ended with status $status"
printf 'ok      the module lives in the kernel of %s\n' "$variant"

# The module with one line of hvp_pci.c changed is found by what its kernel prints.
find_fault() { # name, line, what it becomes, parameter of the module, words
  local checkout=$work/$1
  mkdir "$checkout"
  cp -r "$top/driver" "$top/cmake" "$top/packages.txt" "$checkout"
  sed -i "s/$2/$3/" "$checkout/driver/linux/hvp_pci.c"
  ! cmp -s "$checkout/driver/linux/hvp_pci.c" "$top/driver/linux/hvp_pci.c" || {
    printf 'FAILED: hvp_pci.c has no %s\n' "$2"
    exit 1
  }
  "$checkout/driver/linux/build.sh" "$kernels/$variant/tree" "$work/$1-module"
  "$top/driver/linux/guest/initramfs.sh" "$work/$1.gz" "$work/$1-module/hvp.ko" "${programs[@]}"
  printf '%s\n' "rmmod hvp && insmod /lib/hvp.ko $4" \
    'hvp-driver-suite /dev/hvp0 --case solve' >"$work/script"
  # What follows the complaint is as it may be, a panic among it.
  boot "$kernels/$variant/linux" "$work/$1.gz" "$work/script" || true
  grep -q "$5" "$work/out/console.log" || give_up "$1 does not say $5"
  # The verdict names it too.
  grep -q "\"text\": \"$5" "$work/out/summary.json" || give_up "the verdict does not say $5"
  printf 'ok      %s is found: %s\n' "$3" "$5"
}
# The driver's memory for a burst is too short; a lock is not made.
find_fault kasan 'kmalloc(sizeof(hvp__U_t), GFP_KERNEL)' 'kmalloc(64, GFP_KERNEL)' dma=0 \
  'BUG: KASAN: slab-out-of-bounds'
find_fault lockdep 'spin_lock_init(&board->line_lock);' '(void)board;' msi=0 \
  'INFO: trying to register non-static key'

# Mistakes of docs/driver-bugs.md.
python3 -B "$here/module_bugs.py" "$hvp" "$kernels/$variant" "$kernels/$variant/variants" --checked

# What has found something, and every kind of board.
stress() { python3 -B "$here/stress_test.py" "$hvp" "$kernels/$variant" --seconds 60 "$@"; }
stress
stress --seeds 9 13
