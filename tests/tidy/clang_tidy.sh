#!/usr/bin/env bash
# Stands before clang-tidy in build-tidy: third parties' headers are parsed once, not in each of 600 files. Called
# as `clang_tidy.sh prepare` it makes them; else as clang-tidy, with the compiler's command after `--`.
# Files that are compiled for another instruction set, in C, or without Eigen are looked at without.
set -euo pipefail
folder=build-tidy/third_parties
top=$(cd "$(dirname "$0")/../.." && pwd)

prepare() {  # prepare NAME DEFINITIONS… -- HEADERS…
  local name=$1 definitions=()
  shift
  while [ "$1" != -- ]; do definitions+=("$1"); shift; done
  shift
  printf '#include <%s>\n' "$@" >"$folder/$name.h"
  # -O1, -fPIC: what most files are compiled with; clang minds neither.
  clang++ -x c++-header -std=c++20 -O1 -DNDEBUG -fPIC -ffp-contract=off -isystem /usr/include/eigen3 "${definitions[@]}" \
    -fpch-instantiate-templates "$folder/$name.h" -o "$folder/$name.pch"
}

if [ "${1:-}" = prepare ]; then
  mkdir -p "$folder"
  prepare plain -- Eigen/Core Eigen/Geometry nlohmann/json.hpp
  prepare tests -DGTEST_HAS_PTHREAD=1 -- Eigen/Core Eigen/Geometry gtest/gtest.h nlohmann/json.hpp
  exit 0
fi
command=" $* " header=plain
[[ $command == *' -DGTEST_HAS_PTHREAD=1 '* ]] && header=tests
other='( -m[a-z]| -O0 | -DEIGEN| -fno-math-errno| -fvisibility|\.c )'
if [[ $command =~ $other || $command != *eigen3* ]]; then exec clang-tidy "$@"; fi
before=()
while [ "$1" != -- ]; do before+=("$1"); shift; done
exec clang-tidy "${before[@]}" -- -include-pch "$top/$folder/$header.pch" "${@:2}" -fPIC
