#!/bin/busybox sh
# shellcheck shell=dash
# What befalls a board while hvp-stress uses it, as a script of the guest's (docs/linux-driver.md):
# the function is unbound, reset, taken off the bus, and all goes to sleep, at times that the seed
# draws. Then the board must solve, and nothing must be left of it.
#   stress.sh SEED SECONDS [WORD…]   the words are hvp-stress'
# Ends with 0, or with 1 and a line that begins with FAILED.
set -u
seed=$1 seconds=$2
shift 2
address=$(cd /sys/bus/pci/drivers/hvp && echo 0000:*)
function=/sys/bus/pci/devices/$address
driver=/sys/bus/pci/drivers/hvp
status=0

fail() {
  echo "FAILED: $*"
  status=1
}
draw() { # limit: $drawn is from 0 to below it
  seed=$(((seed * 1103515245 + 12345) & 0x7fffffff))
  drawn=$(((seed >> 8) % $1))
}
pause() { # the longest, in ms
  draw "$1"
  usleep $((1000 + 1000 * drawn))
}

# A board that is gone for a while is found later.
give_back() {
  tries=0
  while [ ! -e "$driver/$address" ] && [ "$tries" -lt 20 ]; do
    echo "$address" >"$driver/bind" || usleep 50000
    tries=$((tries + 1))
  done 2>/dev/null
  [ -e "$driver/$address" ] || fail 'the board cannot be given back'
}
rebind() {
  echo "$address" >"$driver/unbind" || fail 'the board cannot be taken away'
  pause 30
  give_back
}
rescan() {
  echo 1 >"$function/remove" || fail 'the function cannot be removed'
  pause 30
  echo 1 >/sys/bus/pci/rescan
  give_back
}
# The alarm is in whole seconds: one that is over before all sleep would wake nobody.
sleep_and_wake() {
  echo 0 >/sys/class/rtc/rtc0/wakealarm
  echo +2 >/sys/class/rtc/rtc0/wakealarm
  echo mem >/sys/power/state || fail 'no suspend'
}
change_timeout() {
  draw 100
  echo $((1 + drawn)) >/sys/module/hvp/parameters/timeout_ms
}

upheave() { # what it may be, a letter each
  resets=0 rebinds=0 rescans=0 suspends=0 timeouts=0
  while [ -e /tmp/stressing ]; do
    pause 700
    draw 13
    case $drawn in
      0 | 1 | 2) rebind && rebinds=$((rebinds + 1)) ;;
      3) rescan && rescans=$((rescans + 1)) ;;
      4 | 12) sleep_and_wake && suspends=$((suspends + 1)) ;;
      5) change_timeout && timeouts=$((timeouts + 1)) ;;
      *) echo 1 >"$function/reset" 2>/dev/null && resets=$((resets + 1)) ;;
    esac
  done
  echo "upheaval: $resets resets, $rebinds unbound and bound, $rescans removed and found," \
    "$suspends suspends, $timeouts other timeouts"
  exit "$status"
}

hvp-stress /dev/hvp0 "$function" --seed "$seed" --seconds "$seconds" --begun /tmp/stressing "$@" &
program=$!
while [ ! -e /tmp/stressing ] && [ -e /proc/$program ]; do usleep 10000; done
upheave &
upheaval=$!
wait $program || fail 'the stress'
rm -f /tmp/stressing
wait $upheaval || status=1

# What a board that was bound anew has, whatever was done to it.
echo 5000 >/sys/module/hvp/parameters/timeout_ms
rebind
tries=0
# The scenario's faults go on.
until hvp-driver-suite /dev/hvp0 --case solve | grep -q '"pass"'; do
  tries=$((tries + 1))
  [ "$tries" -lt 20 ] || { fail 'no solve after the stress' && break; }
done

# Once what is let go later is let go.
free_kb() {
  sleep 1
  echo 3 >/proc/sys/vm/drop_caches
  awk '/^MemFree:/ {print $2}' /proc/meminfo
}
lives() { # how many
  life=0
  while [ "$life" -lt "$1" ]; do
    exec 5<>/dev/hvp0
    exec 5>&-
    echo "$address" >"$driver/unbind"
    give_back
    life=$((life + 1))
  done
}
# Each life has two vectors of the largest matrix for DMA, 192 KB, and one of its own; lists of
# free pages that are not counted as free are one or two MB.
lives 5
before=$(free_kb)
lives 40
left=$((before - $(free_kb)))
echo "stress: $left KB less after 40 lives of the board"
[ "$left" -lt 3000 ] || fail "40 lives of the board leave $left KB"
rmmod hvp || fail 'the module does not go'
if [ -d /sys/kernel/debug ] && mount -t debugfs none /sys/kernel/debug 2>/dev/null &&
  [ -e /sys/kernel/debug/kmemleak ]; then
  # What is young may be in a register.
  sleep 6
  echo scan >/sys/kernel/debug/kmemleak
  sleep 6
  echo scan >/sys/kernel/debug/kmemleak
  ! grep -A 12 'unreferenced object' /sys/kernel/debug/kmemleak || fail 'memory is lost'
fi
# From the module's coming on: what 6.1 says of itself before is its own.
! dmesg | sed -n '/hvp: loading/,$p' |
  grep -E 'WARNING|BUG|KASAN|KCSAN|INFO: |DMA-API|possible circular|blocked for more than' ||
  fail 'the kernel complains'
# lockdep looks no further after its first complaint.
[ ! -e /proc/lockdep_stats ] || grep -Eq 'debug_locks: +1' /proc/lockdep_stats || fail 'lockdep is off'
exit "$status"
