#!/bin/busybox sh
# shellcheck shell=dash
# What a guest does to the module beside solving, as a script of the guest's (docs/linux-driver.md):
# the board must solve after each of it. Ends with 0, or with 1 and a line that says what failed.
set -u
function=$(echo /sys/bus/pci/drivers/hvp/0000:*)
address=${function##*/}

fail() {
  echo "FAILED: $*"
  exit 1
}
solves() { # after what
  hvp-driver-suite /dev/hvp0 --case solve | grep -q '"pass"' || fail "no solve after $1"
}
passes() { # with what
  hvp-driver-suite /dev/hvp0 >/tmp/said || fail "$1: $(grep '"fail"' /tmp/said | head -n 1)"
  [ "$(grep -c '"pass"' /tmp/said)" -ge 20 ] || fail "$1: most cases were left out"
}
loads() { # parameters…
  rmmod hvp || fail 'the module does not go'
  insmod /lib/hvp.ko "$@" || fail "the module does not load with $*"
}

passes 'as it was loaded'
[ "$(cat "$function/statistics/jobs")" -gt 50 ] || fail 'jobs are not counted'
[ "$(cat "$function/statistics/last_error")" != HVP_OK ] || fail 'errors are not kept'
[ "$(cat "$function/capability/max_nodes")" -gt 0 ] || fail 'no capability'

exec 5<>/dev/hvp0
hvp-driver-suite /dev/hvp0 --case solve 2>&1 | grep -q 'Device or resource busy' ||
  fail 'two programs have the file'
exec 5>&-
solves 'a second program was refused'

exec 5<>/dev/hvp0
echo 1 >"$function/reset" || fail 'the function cannot be reset'
exec 5>&-
solves 'a reset of the function'

echo +2 >/sys/class/rtc/rtc0/wakealarm
echo mem >/sys/power/state || fail 'no suspend'
solves 'a suspend'

exec 5<>/dev/hvp0
echo "$address" >/sys/bus/pci/drivers/hvp/unbind || fail 'the board cannot be taken away'
[ ! -e /dev/hvp0 ] || fail 'the file stays without the board'
exec 5>&-
echo "$address" >/sys/bus/pci/drivers/hvp/bind || fail 'the board cannot be given back'
solves 'the board was away'

loads msi=0
passes 'by a line'
loads dma=0
passes 'by blocks'
loads msi=0 bus_errors=1
passes 'by a line, with questions to the bus'
# From the module's coming on: what 6.1 says of itself before is its own.
! dmesg | sed -n '/hvp: loading/,$p' | grep -E 'WARNING|BUG|KASAN|INFO: |DMA-API|possible circular' ||
  fail 'the kernel complains'
# lockdep looks no further after its first complaint.
[ ! -e /proc/lockdep_stats ] || grep -Eq 'debug_locks: +1' /proc/lockdep_stats || fail 'lockdep is off'
exit 0
