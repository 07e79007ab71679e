#!/usr/bin/env bash
# A guest without a board: tests/driver/linux/boot_test.sh KERNEL INITRAMFS. The kernel starts, the
# module loads with the parameters of the command line and refuses a wrong one, a script of the host
# runs, and its status comes back. No clock of another's: the guest has its own here.
set -euo pipefail
(($# == 2)) || { printf 'expected: boot_test.sh KERNEL INITRAMFS\n' >&2 && exit 2; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT

boot() { # words of the command line…
  rm -f "$folder/status"
  timeout --kill-after=5 120 "$kernel" mem=64M con=null con0=null,fd:1 noreboot panic=-1 \
    "uml_dir=$folder/" umid=guest "initrd=$initrd" "hvp.script=$folder/script" \
    "hvp.status=$folder/status" "$@" </dev/null >"$folder/console" 2>&1 || {
    cat "$folder/console"
    printf 'FAILED: the kernel ended with status %d\n' "$?"
    exit 1
  }
}
expect() { # what, wanted, got
  [[ $2 == "$3" ]] || {
    cat "$folder/console"
    printf 'FAILED: %s: expected %s, got %s\n' "$@"
    exit 1
  }
}
kernel=$(readlink -f -- "$1")
initrd=$(readlink -f -- "$2")

cat >"$folder/script" <<'S'
cd /sys/module/hvp/parameters
cat dma msi bus_errors timeout_ms >"/host${0#/host}.said"
echo 0 >timeout_ms 2>/dev/null && exit 1
echo 60001 >timeout_ms 2>/dev/null && exit 1
echo 250 >timeout_ms
cat timeout_ms >>"/host${0#/host}.said"
rmmod hvp
exit 7
S
boot hvp.dma=0 hvp.timeout_ms=100
expect 'the status of the script' 7 "$(<"$folder/status")"
expect 'the parameters' 'N Y N 100 250' "$(tr '\n' ' ' <"$folder/script.said" | sed 's/ $//')"

printf 'exit 0\n' >"$folder/script"
boot hvp.timeout_ms=0
expect 'the status where the module refuses' '22 insmod' "$(<"$folder/status")"
printf 'ok\n'
