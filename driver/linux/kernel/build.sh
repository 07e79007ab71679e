#!/usr/bin/env bash
# Builds a User-Mode Linux kernel from Debian's linux-source-6.1: the guest of `hvp linux`.
#   driver/linux/kernel/build.sh FOLDER [VARIANT…]
# A variant is a file VARIANT.config beside this one, put on top of base.config: plain (the default),
# kasan, lockdep, debug; or some of them, such as kasan+lockdep, which lie on each other. Each gets
#   FOLDER/VARIANT/linux   the kernel, a program of the host
#   FOLDER/VARIANT/tree    what a module is built against (make -C)
# and debug, beside them, guest.gdb, commands for gdb, and vmlinux: the kernel under the name by which
# the kernel's own commands for gdb look for it.
# Nothing is done for one whose sources and settings are what they were. Ends with 2 for a wrong
# word, with 3 for what fails.
set -euo pipefail
here=$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")
top=$(dirname -- "$(dirname -- "$(dirname -- "$here")")")
# shellcheck source=cmake/build.sh
source "$top/cmake/build.sh"

package=linux-source-6.1
archive=/usr/src/$package.tar.xz

variants() { # their names
  local file
  for file in "$here"/*.config; do basename -- "$file" .config; done | grep -vx base
}

settings() { # variant: its files
  local part
  printf 'base.config\n'
  for part in ${1//+/ }; do printf '%s.config\n' "$part"; done
}

usage() {
  say "expected: driver/linux/kernel/build.sh FOLDER [VARIANT…]; the variants are $(variants | paste -sd ' ')"
  exit 2
}

version() { dpkg-query -W -f='${Version}' "$package"; }

# All that a kernel depends on.
key() { # variant
  printf '%s %s\n' "$package" "$(version)"
  gcc --version | head -n 1
  (cd "$here" && settings "$1" | xargs sha256sum build.sh guest.gdb patches/*.patch)
}

is_built() { # variant
  [[ -x $out/$1/linux && -f $out/$1/key && $(<"$out/$1/key") == "$(key "$1")" ]]
}

made_of() {
  version
  printf '\n'
  cat "$here"/patches/*.patch
}

# The sources, without those of other machines and of devices that no guest has: half the room.
unpack() {
  local folder=$1 patch fresh
  ! cmp -s <(made_of) "$folder/.hvp-made-of" || return 0
  fresh=$folder.new
  rm -rf "$fresh" && mkdir -p "$fresh"
  say "unpacking $archive"
  local -a without=(--exclude="$package/Documentation/*/*" --exclude="$package/tools/"{testing,perf})
  # Their settings stay: those of the rest refer to them.
  local room
  for room in drivers/{gpu,infiniband,media,net,scsi,staging,usb} sound fs/{btrfs,xfs,ocfs2} net \
    arch/{alpha,arc,arm,arm64,csky,hexagon,ia64,loongarch,m68k,microblaze,mips,nios2,openrisc,parisc,powerpc,riscv,s390,sh,sparc,xtensa}; do
    without+=(--exclude="$package/$room/*.[chS]" --exclude="$package/$room/*.dts" --exclude="$package/$room/*.dtsi")
  done
  tar -C "$fresh" --strip-components=1 "${without[@]}" -xf "$archive" ||
    fail "$archive could not be unpacked; the lines above say why"
  for patch in "$here"/patches/*.patch; do
    patch --quiet -d "$fresh" -p1 <"$patch" || fail "$(basename "$patch") does not fit $package $(version)"
  done
  made_of >"$fresh/.hvp-made-of"
  rm -rf "$folder"
  mv -T "$fresh" "$folder"
}

in_tree() { make -C "$source" ARCH=um SUBARCH=x86_64 O="$tree" "${toolchain[@]}" "$@"; }

# A line for every hundred files that were compiled.
follow() { # variant log
  local line files=0
  while IFS= read -r line; do
    printf '%s\n' "$line" >>"$2"
    [[ $line != *' CC '* ]] || {
      files=$((files + 1))
      ((files % 100 != 0)) || say "kernel $1: $files files compiled, $SECONDS s"
    }
  done
}

# A setting that others rule out is dropped without a word: that must not pass for one that is there.
check_config() { # variant
  local line
  while IFS= read -r line; do
    case $line in
      CONFIG_* | '# CONFIG_'*' is not set') ;;
      *) continue ;;
    esac
    if [[ $line == '#'* ]]; then
      ! grep -q "^${line:2:-11}=" "$tree/.config"
    else
      grep -qxF -- "$line" "$tree/.config"
    fi || fail "kernel $1: the sources do not take the setting '$line'"
  done < <(cd "$here" && settings "$1" | xargs cat)
}

build_kernel() { # variant
  ! is_built "$1" || return 0
  local source fresh=$out/$1.new log=$out/$1.log
  local tree=$fresh/tree
  source=$out/source-$(version)
  local -a toolchain=(
    # The same sources and settings make the same kernel, on any day and for anyone.
    'KBUILD_BUILD_TIMESTAMP=1970-01-01' KBUILD_BUILD_USER=hvp KBUILD_BUILD_HOST=hvp
  )
  if command -v ccache >/dev/null; then
    toolchain+=('CC=ccache gcc' 'HOSTCC=ccache gcc')
    [[ -n ${CCACHE_DIR:-} || -w ${HOME:-/nonexistent} ]] || export CCACHE_DIR=${build:?}/ccache
    export CCACHE_BASEDIR=$out CCACHE_NOHASHDIR=1
  fi
  unpack "$source"
  SECONDS=0
  rm -rf "$fresh" && mkdir -p "$tree"
  : >"$log"
  say "kernel $1: configuring"
  {
    in_tree tinyconfig &&
      (cd "$here" && settings "$1" | xargs "$source/scripts/kconfig/merge_config.sh" -m -O "$tree" "$tree/.config") &&
      in_tree olddefconfig
  } >>"$log" 2>&1 || give_up "$1" "$log"
  check_config "$1"
  say "kernel $1: compiling with $HVP_JOBS jobs"
  local -a targets=(linux modules)
  ! grep -qx CONFIG_GDB_SCRIPTS=y "$tree/.config" || targets+=(scripts_gdb)
  in_tree -j "$HVP_JOBS" "${targets[@]}" 2>&1 | follow "$1" "$log" || give_up "$1" "$log"
  mv "$tree/linux" "$fresh/linux"
  if [[ -e $tree/vmlinux-gdb.py ]]; then
    ln "$fresh/linux" "$fresh/vmlinux"
    cp -p "$here/guest.gdb" "$fresh/guest.gdb"
  fi
  # A module needs the headers, the settings and the programs in scripts/.
  find "$tree" -path "$tree/scripts" -prune -o \( -name '*.o' -o -name '*.a' -o -name 'vmlinux*' -o -name '.*.cmd' \) -type f -print0 |
    xargs -0 rm -f
  key "$1" >"$fresh/key"
  rm -rf "${out:?}/$1"
  mv -T "$fresh" "$out/$1"
  say "kernel $1: $(du -h "$out/$1/linux" | cut -f 1) after $SECONDS s"
}

give_up() { # variant log
  tail -n 30 "$2" >&2
  fail "kernel $1: the build failed; the whole output is in $2"
}

(($# >= 1)) || usage
[[ $1 != -* ]] || usage
wanted=("${@:2}")
((${#wanted[@]})) || wanted=(plain)
for variant in "${wanted[@]}"; do
  [[ $variant =~ ^[a-z]+(\+[a-z]+)*$ ]] || usage
  for part in ${variant//+/ }; do variants | grep -qxF -- "$part" || usage; done
done
mkdir -p "$1" 2>/dev/null || fail "cannot write to $1"
out=$(readlink -f -- "$1")
[[ -f $archive ]] || fail "$archive is missing; run as root: apt-get install -y --no-install-recommends $(missing_packages run linux)"
set_jobs
build_all() {
  local variant
  for variant in "${wanted[@]}"; do build_kernel "$variant"; done
}
locked "$out" build_all
