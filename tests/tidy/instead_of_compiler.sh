#!/usr/bin/env bash
# Stands before the compiler and the linker in build-tidy, where files are looked at but never compiled: writes the
# list of headers that a file includes (so the next run looks at what changed) and an empty object; instead of a
# program, one that does nothing.
set -euo pipefail
command=() depends='' output=''
while [ $# -gt 0 ]; do
  case $1 in
    -o) output=$2; shift ;;
    -c) ;;
    -MD) depends=yes; command+=(-M) ;;
    *) command+=("$1") ;;
  esac
  shift
done
if [ -n "$depends" ]; then
  "${command[@]}"
  : >"$output"
else
  echo '#!/bin/sh' >"$output"
  chmod +x "$output"
fi
