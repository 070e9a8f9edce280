# SPDX-License-Identifier: Apache-2.0
# Sourced by ./demo, ./test and .ci/run: installs missing Debian packages and builds presets.

# What the program needs to be built.
BUILD_PACKAGES="g++ cmake ninja-build pkg-config libhwy-dev libflatbuffers-dev
    flatbuffers-compiler zlib1g-dev libtbb-dev libeigen3-dev libjpeg62-turbo-dev libpng-dev
    libopenexr-dev libtiff-dev libzip-dev libembree-dev libtinyobjloader-dev libcli11-dev libfmt-dev
    nlohmann-json3-dev"
# What the tests need besides.
TEST_PACKAGES="libgtest-dev libgmock-dev libfftw3-dev librandom123-dev python3"
# What the viewer needs: a compiler to WebAssembly, and a browser to test in.
WASM_PACKAGES="emscripten"
BROWSER_PACKAGES="chromium fonts-dejavu-core"
# What tools/make_gallery.py needs: pictures are laid out by Pillow.
GALLERY_PACKAGES="python3-pil fonts-dejavu-core"
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

# install_node: any Node from 18 with npm will do; the distribution's where there is none.
install_node() {
    if command -v npm > /dev/null &&
        [ "$(node -p 'Number(process.versions.node.split(".")[0]) >= 18' 2> /dev/null)" = true ]; then
        return
    fi
    install_missing nodejs npm
}

# npm_ci: the packages of the viewer, exactly those of its lock file, unless they are there.
npm_ci() {
    if cmp -s viewer/package-lock.json viewer/node_modules/.installed-lock.json; then return; fi
    say "installing the viewer's packages"
    npm ci --prefix viewer --no-audit --no-fund > "$LOG_DIR/npm.log" 2>&1 ||
        die "npm could not install the viewer's packages: see $LOG_DIR/npm.log"
    cp viewer/package-lock.json viewer/node_modules/.installed-lock.json
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
