#!/usr/bin/env bash
# Installs what the tests need and runs them all: fmt, clippy, docs, tests. Any Debian machine with Rust and git.
set -euo pipefail
cd "$(dirname "$0")"

vulkan_present() {
    local libraries
    libraries=$(ldconfig -p)
    { compgen -G '/usr/share/vulkan/icd.d/*.json' || compgen -G '/etc/vulkan/icd.d/*.json'; } >/dev/null && grep -qF 'libvulkan.so.1' <<<"$libraries"
}

# install_missing WHAT VARIABLE TESTS PACKAGES...: installs packages, or says how to.
install_missing() {
    local what=$1 variable=$2 tests=$3 get="apt-get"
    shift 3
    [ $# -gt 0 ] || return 0
    if ! command -v apt-get >/dev/null; then
        echo "The tests need $what; install what Debian calls: $*" >&2
        echo "or run without the $tests:  $variable=1 ./test.sh" >&2
        exit 1
    elif [ "$(id -u)" != 0 ]; then
        if ! command -v sudo >/dev/null || ! sudo -n true 2>/dev/null; then
            echo "The tests need $what. Type:  sudo apt-get install $*" >&2
            echo "or run without the $tests:  $variable=1 ./test.sh" >&2
            exit 1
        fi
        get="sudo DEBIAN_FRONTEND=noninteractive apt-get"
    fi
    $get update -q && DEBIAN_FRONTEND=noninteractive $get install -y -q --no-install-recommends "$@"
}

# The GPU kernels are tested on software Vulkan where there is no GPU.
if [ "${PAIRWAVE_ALLOW_NO_GPU:-}" != 1 ] && ! vulkan_present; then
    install_missing "software Vulkan" PAIRWAVE_ALLOW_NO_GPU "GPU tests" mesa-vulkan-drivers libvulkan1
fi
# The viewer opens a real window in a virtual X server; winit loads the X libraries when it runs.
if [ "${PAIRWAVE_ALLOW_NO_DISPLAY:-}" != 1 ]; then
    packages="" libraries=$(ldconfig -p)
    command -v Xvfb >/dev/null || packages="xvfb"
    for library in libxkbcommon-x11.so.0:libxkbcommon-x11-0 libX11.so.6:libx11-6 libX11-xcb.so.1:libx11-xcb1 \
        libXcursor.so.1:libxcursor1 libXi.so.6:libxi6 libXrender.so.1:libxrender1 libXfixes.so.3:libxfixes3; do
        grep -qF "${library%%:*}" <<<"$libraries" || packages="$packages ${library##*:}"
    done
    install_missing "a virtual X server and its libraries" PAIRWAVE_ALLOW_NO_DISPLAY "window test" $packages
fi
# Pages are opened in a browser.
if [ "${PAIRWAVE_ALLOW_NO_BROWSER:-}" != 1 ]; then
    browser=""
    command -v chromium chromium-browser google-chrome google-chrome-stable >/dev/null || browser="chromium"
    install_missing "a browser" PAIRWAVE_ALLOW_NO_BROWSER "browser tests" $browser
fi
# The wheel for Python has tests in Python; what they need is fetched while everything else is built.
if [ "${PAIRWAVE_ALLOW_NO_PYTHON:-}" != 1 ]; then
    python="" venv=target/python
    python3 -c 'import sys, venv, ensurepip; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || python="python3-venv"
    install_missing "Python 3.11 or later" PAIRWAVE_ALLOW_NO_PYTHON "Python tests" $python
    [ -x "$venv/bin/pip" ] || python3 -m venv "$venv"
    "$venv/bin/pip" install -q --disable-pip-version-check -r python/tests/requirements.txt >"$venv/requirements.log" 2>&1 &
    requirements=$!
else
    # What is checked of the package for it needs none.
    export PYO3_NO_PYTHON=1
fi
# Mesa's device-select layer asks for this directory and complains on stderr without it.
if [ -z "${XDG_RUNTIME_DIR:-}" ]; then
    XDG_RUNTIME_DIR=$(mktemp -d) && export XDG_RUNTIME_DIR
    trap 'rm -rf "$XDG_RUNTIME_DIR"' EXIT
fi

if command -v rustup >/dev/null; then
    rustup component list --installed 2>/dev/null | grep -q '^clippy' || rustup component add clippy
    rustup component list --installed 2>/dev/null | grep -q '^rustfmt' || rustup component add rustfmt
    rustup target list --installed 2>/dev/null | grep -q '^wasm32-unknown-unknown' || rustup target add wasm32-unknown-unknown
fi

set -x
cargo fmt --all --check
cargo clippy --workspace --all-targets --profile test -- -D warnings
RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --document-private-items --profile test
cargo test --workspace
if [ "${PAIRWAVE_ALLOW_NO_PYTHON:-}" != 1 ]; then
    wait "$requirements" || { cat "$venv/requirements.log" >&2; exit 1; }
    rm -rf target/wheels
    "$venv/bin/maturin" build -q --profile wheel --manifest-path python/Cargo.toml --interpreter "$venv/bin/python" --out target/wheels
    "$venv/bin/pip" install -q --disable-pip-version-check --force-reinstall --no-deps target/wheels/pairwave-*.whl
    PAIRWAVE_PROGRAM="${CARGO_TARGET_DIR:-$PWD/target}/debug/pairwave" "$venv/bin/python" -m pytest python
fi
# The library and the command line need no GUI crate.
tree=$(cargo tree -p pairwave -e normal,build,dev --prefix none)
! grep -E '^(egui|eframe|winit|rfd)' <<<"$tree" || exit 1
# The library speaks no command line unless it is asked to.
tree=$(cargo tree -p pairwave --no-default-features -e normal --prefix none)
! grep -E '^(clap|indicatif|ctrlc|terminal_size)' <<<"$tree" || exit 1
# It builds without one, and with the viewer stays fit for a browser: both for that, which shares what they need.
if [ -d "$(rustc --print sysroot)/lib/rustlib/wasm32-unknown-unknown" ]; then
    # Not in the profile of tests, which would check what only tests need too.
    export RUSTFLAGS="-D warnings"
    cargo check --target wasm32-unknown-unknown -p pairwave --no-default-features --lib
    cargo check --target wasm32-unknown-unknown -p pairwave-viewer --lib
else
    cargo clippy -p pairwave --no-default-features --lib --profile test -- -D warnings
fi
