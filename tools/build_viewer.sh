#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the viewer as one page, viewer/dist/viewer.html, puts it where the program looks
# for it, and builds the package in viewer/dist/lib. Needs the module of tools/build_wasm.sh.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/setup.sh

command -v npm > /dev/null || die "npm is missing: apt-get install nodejs npm"
npm_ci
say "building the viewer"
{ node viewer/tools/embed_wasm.mjs && npm run build --prefix viewer &&
    npm run build:lib --prefix viewer; } > "$LOG_DIR/build-viewer.log" 2>&1 || {
    tail -n 20 "$LOG_DIR/build-viewer.log" >&2
    die "building the viewer failed: see $LOG_DIR/build-viewer.log"
}
for preset in release dev; do
    if [ -d "build/$preset" ]; then
        mkdir -p "build/$preset/share/sateen"
        cp viewer/dist/viewer.html "build/$preset/share/sateen/viewer.html"
    fi
done
