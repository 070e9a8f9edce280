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

# run_node NAME FILE ATTEMPTS: a browser drawing in software can miss a time limit on a busy
# machine, so its tests may be tried again; what fails twice has failed.
run_node() {
    local attempt
    for ((attempt = 1; attempt <= $3; ++attempt)); do
        say "testing $1"
        if node --test "$2" > "$LOG_DIR/test-$1.log" 2>&1; then return; fi
        grep -A 25 '^ *not ok' "$LOG_DIR/test-$1.log" >&2 || true
        say "the tests of $1 failed in attempt $attempt of $3"
    done
    die "the tests of $1 failed: see $LOG_DIR/test-$1.log"
}
run_node runtime viewer/tests/runtime.test.mjs 1
run_node page viewer/tests/page.test.mjs 2
