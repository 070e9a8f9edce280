#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the WebAssembly runtime and the viewer, and tests both: the runtime in Node against the
# program that SATEEN names, the page in headless Chromium.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/setup.sh

SATEEN=$(realpath "${SATEEN:-build/release/bin/sateen}") && [ -x "$SATEEN" ] ||
    die "the program is not built"
export SATEEN
# shellcheck disable=SC2086
install_missing $BUILD_PACKAGES $WASM_PACKAGES $BROWSER_PACKAGES
install_node
tools/build_wasm.sh
tools/build_viewer.sh

# run_node NAME
run_node() {
    say "testing $1"
    if node --test "viewer/tests/$1.test.mjs" > "$LOG_DIR/test-$1.log" 2>&1; then return; fi
    grep -A 25 '^ *not ok' "$LOG_DIR/test-$1.log" >&2 || true
    die "the tests of $1 failed: see $LOG_DIR/test-$1.log"
}
for name in runtime evaluation page package; do run_node "$name"; done
