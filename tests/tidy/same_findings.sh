#!/usr/bin/env bash
# Shows that own_declarations.cpp drops nothing: with far more checks switched on than the project uses, clang-tidy
# reports the same for each file with the plugin as without. About a minute per file; tests/run.sh --all comes first.
# Usage: tests/tidy/same_findings.sh [FILE…]     without files: one of each kind
set -euo pipefail
cd "$(dirname "$0")/../.."
plugin=build-tidy/own_declarations.so
[ -f "$plugin" ] || { echo "same_findings: $plugin is not there: run tests/run.sh --all first" >&2; exit 1; }
[ $# -gt 0 ] || set -- runtime/sinew/skeleton/skeleton.cpp tests/character/loop_test.cpp tools/render/camera.cpp \
  tools/study/stage.cpp samples/crowd/main.cpp tests/import/conversion_test.cpp tools/cli/evaluate.cpp
checks='-*,bugprone-*,performance-*,modernize-*,readability-*,cppcoreguidelines-*,misc-*,-misc-no-recursion,cert-*,google-*,hicpp-*'

findings() {  # findings FILE OPTIONS…
  local file=$1
  shift
  # What is found makes it fail: that is the point here. Notes belong to the finding above them.
  { clang-tidy -p build-tidy --quiet "$@" "$file" 2>/dev/null || true; } | grep -E ': (warning|error):' | sort -u
}

different=0
for file in "$@"; do
  all=$(findings "$file" --checks="$checks")
  own=$(findings "$file" --checks="$checks,sinew-own-declarations" --load="$plugin")
  echo "$file: $(wc -l <<<"$all") findings without the plugin, $(wc -l <<<"$own") with it"
  diff <(echo "$all") <(echo "$own") || different=1
done
exit $different
