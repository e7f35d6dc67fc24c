#!/usr/bin/env bash
# Shows the page that build.sh made in headless Chromium, which throws a ball at the walker and knocks it out (test.js):
# there must be a picture, unknowns, no fault, and the pose hash that the sample in C has here.
# Usage: samples/web/test.sh FOLDER SAMPLE_C [PICTURE.jpg]     SAMPLE_C: build/samples/sample_c
set -euo pipefail
[ $# -ge 2 ] || { echo "usage: samples/web/test.sh FOLDER SAMPLE_C [PICTURE.jpg]" >&2; exit 2; }
if [ ! -e "$1/page/sinew.wasm" ] || ! command -v chromium >/dev/null; then
  echo "skipped: samples/web/build.sh has not made a page in $1, or chromium is not there" >&2
  exit 77
fi
hash_of() {  # hash_of FRAMES
  "$sample" "$page/mannequin.sinew" "$1" | sed -n 's/^pose hash //p'
}
sample=$2 page=$1/page
log=$(mktemp)
python3 -u -m http.server -b 127.0.0.1 -d "$page" 0 >"$log" 2>&1 &
server=$!
trap 'kill "$server"; rm -f "$log" "$log.page" "$log.chromium"' EXIT
for _ in $(seq 100); do
  port=$(sed -n 's/^Serving HTTP on .* port \([0-9]*\).*/\1/p' "$log")
  [ -z "$port" ] || break
  sleep 0.1
done
timeout 300 chromium --headless --no-sandbox --disable-dev-shm-usage --no-first-run --use-angle=swiftshader \
  --enable-unsafe-swiftshader --window-size=1280,720 --virtual-time-budget=60000 --enable-logging=stderr --dump-dom \
  "http://127.0.0.1:$port/?test" >"$log.page" 2>"$log.chromium" || { cat "$log.chromium" >&2; exit 1; }
python3 - "$(hash_of 60) $(hash_of 180)" "$log.page" "$log.chromium" "${3:-}" <<'END'
import base64, html, json, re, sys
page, spoken = open(sys.argv[2]).read(), open(sys.argv[3]).readlines()
title = html.unescape(re.search(r'<title>(.*?)</title>', page, re.S).group(1))
faults = ['console: ' + line.strip() for line in spoken if 'CONSOLE' in line and re.search(r'error|Uncaught', line, re.I)]
if not title.startswith('done '):
    sys.exit('\n'.join(['the page did not end: ' + title] + faults))
result = json.loads(title[5:])
picture = base64.b64decode(result.pop('picture').split(',')[1])
if sys.argv[4]: open(sys.argv[4], 'wb').write(picture)
print(result)
for part, here in zip(('played', 'hit'), sys.argv[1].split()):
    if result[part] != here: faults.append(f"pose hash of what is {part} {result[part]}, {here} from C")
if result['frames'] < 120: faults.append('too few frames')
if result['colours'] < 100: faults.append('an empty picture')
if result['unknowns'] == 0: faults.append('the ball had no effect')
if not 0.1 < result['height'] < 0.7: faults.append('who was knocked out did not fall')
sys.exit('\n'.join(faults) if faults else 0)
END
