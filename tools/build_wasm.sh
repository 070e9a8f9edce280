#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the runtime as build/wasm/bin/sateen.wasm. Needs Debian's emscripten.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/setup.sh

command -v emcmake > /dev/null ||
    die "emscripten is missing: apt-get install --no-install-recommends emscripten"
# A Node that is not the distribution's does not look where Debian keeps emscripten's packages.
export NODE_PATH="/usr/share/nodejs${NODE_PATH:+:$NODE_PATH}"
say "building preset wasm"
{ emcmake cmake --preset wasm && cmake --build --preset wasm --target sateen_wasm; } \
    > "$LOG_DIR/build-wasm.log" 2>&1 || {
    tail -n 30 "$LOG_DIR/build-wasm.log" >&2
    die "building the WebAssembly module failed: see $LOG_DIR/build-wasm.log"
}
