#!/usr/bin/env bash
# Proves on a bare Debian 12 what the README promises: makes a minimal system in a folder, puts a
# clean clone of the last commit into it and runs the two commands there, with no compiler cache and
# packages to be fetched. At the end it prints how long each took, in wall-clock and processor time.
# Takes root, debootstrap and about an hour; the machine's own package sources are used.
#   tests/bare-machine.sh FOLDER                       the README's two commands
#   tests/bare-machine.sh FOLDER './hvp device …' …    others, each by a shell in the clone
# FOLDER/base.tar.gz, made once, is the untouched minimal system; FOLDER/machine is made anew.
set -euo pipefail
top=$(dirname -- "$(dirname -- "$(readlink -f -- "${BASH_SOURCE[0]}")")")
folder=$(readlink -f -- "${1:?a folder for the machine}")
commands=("${@:2}")
((${#commands[@]})) || commands=('./hvp run scenarios/sphere-in-hand.toml' './hvp test')
machine=$folder/machine

debian_sources() { # format
  apt-get indextargets --format "$1" 'Created-By: Packages' 'Origin: Debian' 'Component: main' |
    sort -u
}

make_base() {
  [[ ! -f $folder/base.tar.gz ]] || return 0
  local mirror
  # shellcheck disable=SC2016  # apt-get fills these in
  mirror=$(debian_sources '$(RELEASE) $(REPO_URI)' | sed -n 's/^bookworm //p' | head -n 1)
  debootstrap --variant=minbase bookworm "$folder/base" "$mirror"
  tar -C "$folder/base" -czf "$folder/base.tar.gz.new" .
  mv "$folder/base.tar.gz.new" "$folder/base.tar.gz"
  rm -rf --one-file-system "$folder/base"
}

# The machine is new, but it stands in this network: same package sources, same proxies, same
# certificates.
place_in_network() {
  rm -f "$machine/etc/apt/sources.list"
  # shellcheck disable=SC2016  # apt-get fills these in
  debian_sources 'deb $(REPO_URI) $(RELEASE) $(COMPONENT)' >"$machine/etc/apt/sources.list"
  apt-config dump Acquire >"$machine/etc/apt/apt.conf.d/99network"
  cp -L /etc/resolv.conf /etc/hosts "$machine/etc/"
  # Beside the file that the package ca-certificates will write there.
  mkdir -p "$machine/etc/ssl"
  [[ ! -f /etc/ssl/certs/ca-certificates.crt ]] ||
    cp -L /etc/ssl/certs/ca-certificates.crt "$machine/etc/ssl/network.crt"
}

network_environment() {
  env | grep -iE '^(https?_proxy|no_proxy|PIP_INDEX_URL|PIP_PROXY)=' || true
  [[ ! -f $machine/etc/ssl/network.crt ]] || printf 'PIP_CERT=/etc/ssl/network.crt\n'
}

mkdir -p "$folder"
make_base
rm -rf --one-file-system "$machine"
mkdir "$machine"
tar -C "$machine" -xzf "$folder/base.tar.gz"
place_in_network
git -c safe.directory='*' clone --quiet --no-local "$top" "$machine/src/hvp"
mapfile -t environment < <(network_environment)

# The mounts live in a namespace of their own and go with it.
# shellcheck disable=SC2016  # the inner shell expands them
in_machine='
  machine=$1
  mount -t proc proc "$machine/proc"
  mount --rbind /dev "$machine/dev"
  exec chroot "$machine" /usr/bin/env -i "${@:2}"
'
failed=0
figures=()
TIMEFORMAT='%R %U %S'
for command in "${commands[@]}"; do
  printf '== bare machine: %s\n' "$command"
  status=0
  { time unshare --mount --pid --fork --kill-child bash -c "$in_machine" bash "$machine" \
    HOME=/root PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin TERM=dumb \
    "${environment[@]}" bash -c "cd /src/hvp && $command" 2>&3; } 3>&2 2>"$folder/time" || status=$?
  read -r wall user system <"$folder/time"
  figures+=("$(printf '%8.0f s %8.0f s   exit %d   %s' "$wall" \
    "$(awk "BEGIN { print $user + $system }")" "$status" "$command")")
  ((status == 0)) || failed=1
done
printf '\n== bare machine, %d cores\n%10s %10s\n' "$(nproc)" wall processor
printf '%s\n' "${figures[@]}"
exit "$failed"
