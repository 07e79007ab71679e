#!/usr/bin/env bash
# Packs what the guest has besides its kernel: busybox, `init`, the module and further programs.
#   driver/linux/guest/initramfs.sh OUT.cpio.gz MODULE.ko [FILE…]
# A FILE goes to /bin under its own name. The same files make the same bytes, whoever packs them and
# when. Ends with 2 for a wrong word, with 3 for what fails.
set -euo pipefail
here=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")
top=$(dirname -- "$(dirname -- "$(dirname -- "$here")")")
# shellcheck source=cmake/build.sh
source "$top/cmake/build.sh"

(($# >= 2)) || { say 'expected: driver/linux/guest/initramfs.sh OUT.cpio.gz MODULE.ko [FILE…]' && exit 2; }
out=$1
for file in "${@:2}"; do
  [[ -f $file ]] || { say "expected a file: $file" && exit 2; }
done
busybox=/bin/busybox
# A guest has no libraries.
if [[ ! -x $busybox ]] || ldd "$busybox" >/dev/null 2>&1; then
  fail "$busybox is missing, or needs libraries; run as root: apt-get install -y --no-install-recommends busybox-static"
fi

mkdir -p "$(dirname -- "$out")" 2>/dev/null || fail "cannot write to $out"
root=$(mktemp -d "$out.XXXXXX") || fail "cannot write to $out"
trap 'rm -rf "$root"' EXIT
mkdir -p "$root"/{bin,dev,host,lib,proc,sys,tmp}
install -m 755 "$busybox" "$root/bin/busybox"
install -m 755 "$here/init" "$root/init"
install -m 644 "$2" "$root/lib/hvp.ko"
# What only a debugger asks for is most of a module.
strip --strip-debug "$root/lib/hvp.ko"
for file in "${@:3}"; do install -m 755 "$file" "$root/bin/$(basename -- "$file")"; done
find "$root" -exec touch --no-dereference --date=@0 {} +
(cd "$root" && find . -mindepth 1 -print0 | LC_ALL=C sort -z |
  cpio --quiet --null --create --format=newc --reproducible --owner=+0:+0) | gzip -9n >"$root.gz"
mv -f "$root.gz" "$out"
