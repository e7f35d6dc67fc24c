#!/usr/bin/env bash
# Builds the web page into a folder that any web server can show: Debian's emscripten and npm (three.js) are needed, and
# `sinew`, which converts the character.
# Usage: samples/web/build.sh SINEW [FOLDER=build/web]     then: python3 -m http.server -d FOLDER/page
set -euo pipefail
[ $# -ge 1 ] || { echo "usage: samples/web/build.sh SINEW [FOLDER=build/web]" >&2; exit 2; }
sinew=$(realpath "$1")
folder=$(realpath -m "${2:-build/web}")
here=$(cd "$(dirname "$0")" && pwd)
character=$here/../../assets/character/mannequin
for program in emcmake ninja npm "$sinew"; do
  command -v "$program" >/dev/null || { echo "build.sh: $program is not there (apt-get install emscripten ninja-build npm)" >&2; exit 1; }
done
export NODE_PATH=/usr/share/nodejs  # where Debian's emscripten finds acorn, whichever node runs it

mkdir -p "$folder/page/three/loaders" "$folder/npm"
cp "$here/package.json" "$here/package-lock.json" "$folder/npm"
npm ci --silent --prefix "$folder/npm"
three=$folder/npm/node_modules/three
cp "$three/build/three.module.js" "$folder/page/three"
cp "$three/examples/jsm/loaders/GLTFLoader.js" "$folder/page/three/loaders"
mkdir -p "$folder/page/three/utils"
cp "$three/examples/jsm/utils/BufferGeometryUtils.js" "$folder/page/three/utils"

emcmake cmake -G Ninja -S "$here" -B "$folder/wasm" -DCMAKE_BUILD_TYPE=Release >"$folder/configure.log"
ninja -C "$folder/wasm" sinew story
cp "$folder"/wasm/{sinew,story}.{js,wasm} "$here"/{index.html,page.css,page.js,test.js} "$folder/page"
"$sinew" convert "$character.glb" --options "$character.json" -q -o "$folder/page/mannequin.sinew"
cp "$character.glb" "$folder/page"
echo "$folder/page: sinew.wasm has $(gzip -9 -c "$folder/page/sinew.wasm" | wc -c) bytes compressed"
