#!/usr/bin/env bash
# Shows that poses have the same bits on every processor that this one can be taken for: with SSE2 alone, with AVX2, with
# AVX-512 in the runtime's kernels, and where the C library does without fused multiplication, too.
# Usage: tests/portability/processors.sh POSE_HASHES ASSET.sinew GRAPH.sgraph
# Exits with 1 and names scene, precision and processors where they differ, with 77 where there is only one.
set -euo pipefail
[ $# = 3 ] || { echo "usage: tests/portability/processors.sh POSE_HASHES ASSET.sinew GRAPH.sgraph" >&2; exit 2; }
. "$(dirname "$0")/compare.sh"
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
run_as_processors "$folder" "$@"
if [ ${#machines[@]} -lt 3 ]; then
  echo "skipped: this processor has nothing above the baseline" >&2
  exit 77
fi
table "$folder" "${machines[@]}"
