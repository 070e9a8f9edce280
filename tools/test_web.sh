#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the WebAssembly runtime and tests it. SATEEN names the program to compare
# with.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/setup.sh

SATEEN=$(realpath "${SATEEN:-build/release/bin/sateen}") || die "the program is not built"
export SATEEN
# shellcheck disable=SC2086
install_missing $BUILD_PACKAGES $WASM_PACKAGES
install_node
tools/build_wasm.sh
tools/build_viewer.sh
say "testing the WebAssembly runtime"
node --test viewer/tests/runtime.test.mjs > "$LOG_DIR/test-wasm.log" 2>&1 || {
    grep -A 25 '^ *not ok' "$LOG_DIR/test-wasm.log" >&2
    die "the WebAssembly runtime failed its tests: see $LOG_DIR/test-wasm.log"
}
