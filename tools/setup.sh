# SPDX-License-Identifier: Apache-2.0
# Sourced by ./demo, ./test and .ci/run: installs missing Debian packages and builds presets.

# What the program needs to be built.
BUILD_PACKAGES="g++ cmake ninja-build pkg-config libhwy-dev libflatbuffers-dev
    flatbuffers-compiler zlib1g-dev libtbb-dev libeigen3-dev libjpeg62-turbo-dev libpng-dev
    libopenexr-dev libtiff-dev libzip-dev libcli11-dev libfmt-dev nlohmann-json3-dev"
# What the tests need besides.
TEST_PACKAGES="libgtest-dev libgmock-dev libfftw3-dev librandom123-dev python3"
# What .ci/run needs besides.
CI_PACKAGES="clang-14 libclang-rt-14-dev"

say() { printf '== %s\n' "$*"; }
die() {
    printf '%s: error: %s\n' "$(basename "$0")" "$*" >&2
    exit 1
}

# install_missing PACKAGE...: nothing where all are there.
install_missing() {
    command -v dpkg-query > /dev/null || die "this is not Debian: install $* by hand"
    local package missing=""
    for package in "$@"; do
        case "$(dpkg-query -W -f '${Status}' "$package" 2> /dev/null)" in
            *"ok installed") ;;
            *) missing="$missing $package" ;;
        esac
    done
    if [ -z "$missing" ]; then return; fi
    say "installing$missing"
    local as_root=""
    if [ "$(id -u)" -ne 0 ]; then
        command -v sudo > /dev/null || die "not root and no sudo: install$missing by hand"
        as_root="sudo"
    fi
    # shellcheck disable=SC2086
    { $as_root apt-get update -qq &&
        DEBIAN_FRONTEND=noninteractive $as_root apt-get install -y -qq \
            --no-install-recommends $missing; } > "$LOG_DIR/install.log" 2>&1 ||
        die "could not install$missing: see $LOG_DIR/install.log"
}

# build PRESET [TARGET...]
build() {
    local preset=$1
    shift
    say "building preset $preset"
    cmake --preset "$preset" > "$LOG_DIR/configure-$preset.log" 2>&1 ||
        die "configuring failed: see $LOG_DIR/configure-$preset.log"
    cmake --build --preset "$preset" ${1:+--target "$@"} > "$LOG_DIR/build-$preset.log" 2>&1 || {
        tail -n 30 "$LOG_DIR/build-$preset.log" >&2
        die "building failed: see $LOG_DIR/build-$preset.log"
    }
}

LOG_DIR="$PWD/build/logs"
mkdir -p "$LOG_DIR"
