#!/usr/bin/env bash
# The README's two commands on a bare Debian 12, as a newcomer meets it: HEAD is cloned into a root file system that has
# nothing but git, and both commands run in it, in both orders: as root, demo first; as a user with sudo, tests first.
# Then the demo once more, and neither may have anything left to build or have compiled a file twice.
# Usage: tests/fresh_machine.sh [--order demo|tests] [--keep]
#   --order: only the one that begins with this command     --keep: leave the last root in place, to look around in it
# As root: it makes a root file system. Where it cannot, it says so and is skipped; with CI set, that fails.
# Debian's packages come from the mirror of this machine's own apt sources and are kept for the next root; the compiler
# cache of this machine is shared with the root, which changes no result. Logs: build-fresh/logs.
set -euo pipefail
cd "$(dirname "$0")/.."
work=$PWD/build-fresh root=$PWD/build-fresh/root
release=bookworm seconds_of_third_run=30

cannot() {  # cannot WHY
  echo "fresh machine: SKIPPED: $1" >&2
  [ -z "${CI:-}" ] || { echo "fresh machine: may not be skipped on CI" >&2; exit 1; }
  exit 0
}

options() {
  order='demo tests' keep=
  while [ $# -gt 0 ]; do
    case $1 in
      --keep) keep=yes ;;
      --order) order=${2:-}; shift ;;
      *) sed -n '2,10p' "$0" >&2; exit 2 ;;
    esac
    shift
  done
  case $order in 'demo tests' | demo | tests) ;; *) echo "fresh machine: --order is demo or tests" >&2; exit 2 ;; esac
}

# Everything is mounted in a mount namespace of this script's own: whatever ends it takes the mounts along, and what is
# mounted in the root is never there for somebody else's rm.
own_mounts() {  # own_mounts ARGUMENTS…
  [ -z "${FRESH_OWN_MOUNTS:-}" ] || return 0
  [ "$(id -u)" -eq 0 ] || cannot "must be root, to make a root file system: sudo tests/fresh_machine.sh"
  unshare --mount --propagation private true 2>/dev/null || cannot "this machine lets nobody mount anything (unshare --mount)"
  FRESH_OWN_MOUNTS=yes exec unshare --mount --propagation private "tests/$(basename "$0")" "$@"
}

# "URI RELEASE COMPONENT" of Debian's own archives in either format of apt's sources. Others may need keys of theirs.
sources() {
  # shellcheck disable=SC2016  # apt fills these in
  apt-get indextargets --format '$(REPO_URI) $(RELEASE) $(COMPONENT)' 'Created-By: Packages' |
    grep -E " $release(-updates|-security)? main\$" | sort -u
}

install_debootstrap() {
  command -v debootstrap >/dev/null && return
  { apt-get update && DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends debootstrap; } \
    >"$work/logs/debootstrap.log" 2>&1 || cannot "debootstrap cannot be installed (build-fresh/logs/debootstrap.log)"
}

# Made once; every order begins with a copy. Complete when it has its final name. sudo for the order that needs it.
make_pristine() {
  local mirror log=$work/logs/debootstrap.log
  [ ! -d "$work/pristine" ] || return 0
  install_debootstrap
  mirror=$(sources | awk -v r="$release" '$2 == r {print $1; exit}')
  [ -n "$mirror" ] || cannot "no mirror of Debian $release in this machine's apt sources"
  remove "$work/pristine.part"
  echo "fresh machine: making a root from $mirror …" >&2
  debootstrap --variant=minbase --include=ca-certificates,git,sudo "$release" "$work/pristine.part" "$mirror" >"$log" 2>&1 || {
    tail -n 5 "$log" >&2
    cannot "debootstrap failed (build-fresh/logs/debootstrap.log)"
  }
  sources | sed 's/^/deb /' >"$work/pristine.part/etc/apt/sources.list"
  apt-config dump | grep -E '^Acquire::(http|https|Retries|Check)' >"$work/pristine.part/etc/apt/apt.conf.d/90host" || true  # proxies
  rm -rf "$work"/pristine.part/var/lib/apt/lists/* "$work"/pristine.part/var/cache/apt/archives/*.deb
  mv "$work/pristine.part" "$work/pristine"
}

remove() {  # remove DIRECTORY: nothing that is mounted in it
  if grep -q " $1/" /proc/self/mounts; then
    echo "fresh machine: $1 is not removed: something is mounted in it" >&2
    exit 1
  fi
  rm -rf --one-file-system "$1"
}

mounts() {  # what a machine has: devices, shared memory, the kernel's tables
  mount --rbind /dev "$root/dev"
  mount -t sysfs -o ro sysfs "$root/sys"
  mkdir -p "$work/archives/partial" "$root/ccache" "$cache"
  mount --bind "$work/archives" "$root/var/cache/apt/archives"
  mount --bind "$cache" "$root/ccache"
}

remove_root() {
  local place
  for place in dev sys var/cache/apt/archives ccache; do
    if mountpoint -q "$root/$place"; then umount -R "$root/$place" 2>/dev/null || umount -R -l "$root/$place"; fi
  done
  remove "$root"
}

make_root() {  # make_root USER
  remove_root
  cp -a --reflink=auto "$work/pristine" "$root"
  mounts
  if [ "$1" = root ]; then
    chroot "$root" env SUDO_FORCE_REMOVE=yes dpkg --purge sudo >/dev/null 2>&1
  else
    chroot "$root" useradd -m -s /bin/bash "$1"
    echo "$1 ALL=(ALL) NOPASSWD: ALL" >"$root/etc/sudoers.d/$1"
  fi
  echo "127.0.0.1 localhost $(hostname)" >"$root/etc/hosts"
  git clone -q . "$root/sinew"
  chroot "$root" chown -R "$1" /sinew
}

# As USER in the root, with process ids of its own: nothing that a command leaves running outlives it.
inside() {  # inside USER COMMAND
  local environment=(PATH=/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin CCACHE_DIR=/ccache)
  if [ "$1" = root ]; then
    environment+=(HOME=/root)
  else  # reads the shared cache, which is not its own, and writes nowhere
    environment+=(HOME="/home/$1" LANG=C.UTF-8 CCACHE_READONLY=1 CCACHE_TEMPDIR=/tmp/ccache)
  fi
  unshare --pid --fork --kill-child --mount-proc="$root/proc" \
    chroot "$root" setpriv --reuid "$1" --regid "$1" --init-groups \
    env -i "${environment[@]}" sh -c "cd /sinew && $2" </dev/null
}

bad=
attempt() {  # attempt USER NAME COMMAND [LIMIT IN SECONDS]
  local log=$work/logs/$1-$2.log start=$SECONDS code=0 took
  inside "$1" "$3" >"$log" 2>&1 || code=$?
  took=$((SECONDS - start))
  echo "fresh machine: $1: $3: exit $code after $took s: $(tail -n 1 "$log")"
  if [ $code -ne 0 ]; then
    tail -n 30 "$log" >&2
    bad=yes
  elif [ $took -gt "${4:-100000}" ]; then
    echo "fresh machine: $1: $3 took $took s, though all was made already; at most ${4} s" >&2
    bad=yes
  fi
}

nothing_built_twice() {  # nothing_built_twice USER
  local twice left
  twice=$(awk -F'\t' '$4 ~ /\.(o|gch)$/ && n[$4]++' "$root/sinew/build/.ninja_log" | cut -f4)
  if [ -n "$twice" ]; then
    printf 'fresh machine: %s: compiled twice: %d files, such as:\n%s\n' "$1" "$(wc -l <<<"$twice")" "$(head -n 5 <<<"$twice")" >&2
    bad=yes
  fi
  left=$(inside "$1" 'ninja -C build -n' 2>&1 | tail -n 1)
  if [[ $left != *'no work to do'* ]]; then
    echo "fresh machine: $1: something is left to build after both commands: $left" >&2
    bad=yes
  fi
}

try() {  # try USER COMMAND…
  local user=$1 command
  shift
  make_root "$user"
  for command in "$@"; do attempt "$user" "$(basename "$command" .sh)" "$command"; done
  nothing_built_twice "$user"
  attempt "$user" demo-again tools/demo.sh $seconds_of_third_run
}

leave() {
  [ -n "$keep" ] || remove_root
  # CI has no next run that would use them.
  if [ -n "${CI:-}" ]; then remove "$work/pristine"; remove "$work/archives"; fi
}

options "$@"
own_mounts "$@"
mkdir -p "$work/logs"
cache=$(ccache --get-config cache_dir 2>/dev/null || echo "$work/ccache")
make_pristine
trap leave EXIT
case $order in *demo*) try root tools/demo.sh tests/run.sh ;; esac
case $order in *tests*) try newcomer tests/run.sh tools/demo.sh ;; esac
[ -z "$bad" ] || { echo "fresh machine: FAILED (logs: build-fresh/logs)" >&2; exit 1; }
echo "fresh machine: both commands work on a bare Debian ($order)"
