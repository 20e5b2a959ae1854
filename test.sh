#!/usr/bin/env bash
# Installs what the tests need and runs them all: fmt, clippy, docs, tests. Any Debian machine with Rust and git.
set -euo pipefail
cd "$(dirname "$0")"

vulkan_present() {
    ls /usr/share/vulkan/icd.d/*.json /etc/vulkan/icd.d/*.json >/dev/null 2>&1 && ldconfig -p | grep -q 'libvulkan\.so\.1'
}

# The GPU kernels are tested on software Vulkan where there is no GPU.
if [ "${PAIRWAVE_ALLOW_NO_GPU:-}" != 1 ] && ! vulkan_present; then
    packages="mesa-vulkan-drivers libvulkan1"
    if ! command -v apt-get >/dev/null; then
        echo "The tests need a Vulkan driver; install Mesa's software Vulkan (lavapipe) and the Vulkan loader." >&2
        exit 1
    elif [ "$(id -u)" = 0 ]; then
        apt-get update -q && DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $packages
    elif command -v sudo >/dev/null && sudo -n true 2>/dev/null; then
        sudo apt-get update -q && sudo DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends $packages
    else
        echo "The tests need software Vulkan. Type:  sudo apt-get install $packages" >&2
        echo "or run without the GPU tests:  PAIRWAVE_ALLOW_NO_GPU=1 ./test.sh" >&2
        exit 1
    fi
fi
# Mesa's device-select layer asks for this directory and complains on stderr without it.
if [ -z "${XDG_RUNTIME_DIR:-}" ]; then
    XDG_RUNTIME_DIR=$(mktemp -d) && export XDG_RUNTIME_DIR
    trap 'rm -rf "$XDG_RUNTIME_DIR"' EXIT
fi

if command -v rustup >/dev/null; then
    rustup component list --installed 2>/dev/null | grep -q '^clippy' || rustup component add clippy
    rustup component list --installed 2>/dev/null | grep -q '^rustfmt' || rustup component add rustfmt
fi

set -x
cargo fmt --all --check
cargo clippy --workspace --all-targets --profile test -- -D warnings
RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --document-private-items --profile test
cargo test --workspace
