#!/usr/bin/env bash
# All that a guest is made of, up to date: the kernel, the module for it, and the initramfs.
#   driver/linux/guest.sh FOLDER VARIANT [PROGRAM…]
# The variants are kernel/build.sh's. FOLDER/VARIANT/linux is the kernel then, and
# FOLDER/VARIANT/initramfs.cpio.gz has the module and the programs, which need no library. Ends with
# 2 for a wrong word, with 3 for what fails.
set -euo pipefail
here=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")
(($# >= 2)) || { printf 'hvp: expected: driver/linux/guest.sh FOLDER VARIANT [PROGRAM…]\n' >&2 && exit 2; }
"$here/kernel/build.sh" "$1" "$2"
"$here/build.sh" "$1/$2/tree" "$1/$2/module"
"$here/guest/initramfs.sh" "$1/$2/initramfs.cpio.gz" "$1/$2/module/hvp.ko" "${@:3}"
