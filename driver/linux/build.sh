#!/usr/bin/env bash
# Builds the module against a kernel's tree, with its warnings as errors.
#   driver/linux/build.sh TREE FOLDER [SOURCES]
# TREE is what `make -C` takes: of kernel/build.sh, or a distribution's headers. The sources are
# copied to FOLDER, since a kernel's build leaves its own files beside them; FOLDER/hvp.ko is the
# module. SOURCES, a folder below the checkout, are those of another module. With `sparse` on the
# machine that looks at the sources too. Ends with 2 for a wrong word, with 3 for what fails.
set -euo pipefail
here=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")
top=$(dirname -- "$(dirname -- "$here")")
# shellcheck source=cmake/build.sh
source "$top/cmake/build.sh"

(($# == 2 || $# == 3)) || { say 'expected: driver/linux/build.sh TREE FOLDER [SOURCES]' && exit 2; }
tree=$1
room=driver/linux
(($# == 2)) || room=$(realpath --relative-to="$top" -- "$3")
[[ -f $top/$room/Kbuild ]] || { say "expected a folder with a Kbuild, below $top, not ${3:-$room}" && exit 2; }
config=$tree/include/config/auto.conf
[[ -f $config ]] || { say "expected a kernel's tree that a module can be built against, not $tree" && exit 2; }
mkdir -p "$2/driver/generated" "$2/$room" 2>/dev/null || fail "cannot write to $2"
folder=$(readlink -f -- "$2")

copy() { # from, to
  cp -pu "$1"/*.[ch] "$2"
}

build_module() {
  local -a options=(W=1 KCFLAGS=-Werror)
  ! grep -qx CONFIG_UML=y "$config" || options+=(ARCH=um SUBARCH=x86_64)
  ! command -v sparse >/dev/null || options+=(C=1 CHECK=sparse)
  copy "$top/driver" "$folder/driver"
  copy "$top/driver/generated" "$folder/driver/generated"
  copy "$top/$room" "$folder/$room"
  cp -pu "$top/$room/Kbuild" "$folder/$room"
  make -C "$tree" M="$folder/$room" -j "$HVP_JOBS" "${options[@]}" modules >"$folder/log" 2>&1 || {
    cat "$folder/log" >&2
    fail "the module does not compile against $tree"
  }
  # What a tool finds in the sources is no error of the compiler's. What it finds in the kernel's
  # own headers is not ours.
  ! grep -E "^$folder/.*(warning|error):" "$folder/log" >&2 || fail "the module compiles against $tree with warnings"
  local module
  for module in "$folder/$room"/*.ko; do
    cp -p "$module" "$folder/module.new"
    mv -f "$folder/module.new" "$folder/${module##*/}"
  done
}
set_jobs
locked "$folder" build_module
