#!/usr/bin/env bash
# Installs what Joulepath needs on Debian 12 or Ubuntu 22.04 and 24.04: setup.sh [--yes] [SCOPE...]
#   sil       the compiler, the libraries of the simulator and what its reports need; part of all others
#   design    what makes tables and imports maps
#   operate   what speaks with a robot over CAN or LCM
#   campaign  what runs missions on all cores or a cluster
#   python    what builds the Python package
#   page      what compiles the page in the browser
#   mujoco    design, operate, and the other physics in which robots are driven (tools/mujoco)
#   firmware  the Arm tool chain and its emulator
#   vcan      operate, the CAN tools and, where this kernel has no vcan, one to emulate (tools/operate/with_vcan.sh)
#   test      all of them, the second compiler, the checkers and the RISC-V tool chain (the default)
#   bench     what the planner is measured beside; no part of test
#   mcdc      the compiler that measures MC/DC; no part of test
#   prove     the analyser of `make prove`; no part of test
# Python packages go to .venv, which later calls add to; tools/requirements-*.txt list them.
# JP_SETUP=skip installs nothing and says what is missing, in the Python that PYTHON names. Exit status 2: something could
# not be installed.
set -euo pipefail
cd "$(dirname "$0")/.."
. tools/operate/vcan/common.sh

sil_packages=(build-essential libccd-dev libconfig-dev libjansson-dev liblcm-dev libnlopt-dev pkg-config python3-venv)
vcan_packages=(can-utils iproute2 util-linux)
emulator_packages=(busybox-static qemu-system-x86 xz-utils)
python_packages=(cmake)
page_packages=(clang lld wasi-libc)
firmware_packages=(gcc-arm-none-eabi libnewlib-arm-none-eabi qemu-system-arm)
mujoco_packages=(libegl1 libgl1-mesa-dri)
test_packages=(gcc-multilib clang cmake cppcheck gcc-riscv64-unknown-elf picolibc-riscv64-unknown-elf qemu-system-misc)
bench_packages=(libigraph-dev libompl-dev)
mcdc_packages=(clang-19 libclang-rt-19-dev llvm-19)
prove_packages=(frama-c-base)

die() {
    echo "setup: $*" >&2
    exit 2
}

is_installed() {
    [ "$(dpkg-query -W -f '${db:Status-Status}' "$1" 2>/dev/null)" = installed ]
}

missing_packages() {
    local package
    for package in "$@"; do
        is_installed "$package" || echo "$package"
    done
}

# Of the package, which names of others hold.
clang_version() {
    apt-cache depends clang 2>/dev/null | sed -n 's/.*Depends: clang-\([0-9]*\)$/\1/p' | head -n 1
}

# clang's run-time library with the sanitizers; older releases keep it in libclang-common.
clang_runtime() {
    local version
    version=$(clang_version)
    [ -n "$version" ] || return 0
    if apt-cache show "libclang-rt-$version-dev" >/dev/null 2>&1; then
        echo "libclang-rt-$version-dev"
    else
        echo "libclang-common-$version-dev"
    fi
}

has_clang_runtime() {
    compgen -G "$(clang -print-resource-dir 2>/dev/null)/lib/*/libclang_rt.asan*" >/dev/null
}

has_wasm_runtime() {
    compgen -G "$(clang -print-resource-dir 2>/dev/null)/lib/wasi/libclang_rt.builtins-wasm32.a" >/dev/null
}

has_browser() {
    command -v chromium || command -v chromium-browser || command -v google-chrome
} >/dev/null

# Packages whose names differ from release to release.
missing_by_release() {
    local browser=chromium
    ! wants test || has_clang_runtime || clang_runtime
    ! wants page || has_wasm_runtime || echo "libclang-rt-$(clang_version)-dev-wasm32"
    apt-cache show "$browser" >/dev/null 2>&1 || browser=chromium-browser
    ! wants test || has_browser || echo "$browser"
}

# With a terminal, asks once.
confirm() {
    local answer
    if [ "$yes" = 1 ] || [ ! -t 0 ] || [ ! -t 1 ]; then
        return
    fi
    read -r -p "Install these? [Y/n] " answer
    case $answer in
    '' | [Yy]*) yes=1 ;;
    *) die "nothing was installed; JP_SETUP=skip goes on without" ;;
    esac
}

as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    elif command -v sudo >/dev/null; then
        sudo "$@"
    else
        die "not root and no sudo: install as root: ${missing[*]}"
    fi
}

# apt is quiet but for its errors.
install_packages() {
    echo "setup: apt packages to install: $*"
    confirm
    as_root apt-get update -q >/dev/null ||
        die "apt-get update failed: check the network and /etc/apt/sources.list"
    mapfile -t by_release < <(missing_by_release)
    [ ${#by_release[@]} -eq 0 ] || echo "setup: and what this release calls: ${by_release[*]}"
    set -- "$@" "${by_release[@]}"
    as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y -q --no-install-recommends "$@" >/dev/null ||
        die "apt-get install failed: $*"
}

check_packages() {
    mapfile -t missing < <(missing_packages "$@")
    if [ ${#missing[@]} -eq 0 ] && [ -n "$(missing_by_release)" ]; then
        missing=(clang)
    fi
    [ ${#missing[@]} -eq 0 ] && return
    command -v apt-get >/dev/null || die "no apt-get here; install the counterparts of: ${missing[*]}"
    install_packages "${missing[@]}"
}

# is_current NAME: .venv has what tools/requirements-NAME.txt lists.
is_current() {
    cmp -s "tools/requirements-$1.txt" ".venv/$1.installed" && [ -x .venv/bin/python ]
}

install_requirements() {
    local list=tools/requirements-$1.txt
    echo "setup: Python packages to install in .venv: $(grep -o '^[^# ]*' "$list" | tr '\n' ' ')"
    confirm
    [ -x .venv/bin/python ] || python3 -m venv --clear .venv >/dev/null ||
        die "python3 -m venv failed: the package python3-venv is missing"
    .venv/bin/python -m pip install --quiet --disable-pip-version-check -r "$list" ||
        die "pip could not install $list: check the network"
    cp "$list" ".venv/$1.installed"
}

check_python() {
    local list
    for list in "$@"; do
        is_current "$list" || install_requirements "$list"
    done
}

# Only after the packages: the test of native vcan sends a frame.
check_vcan() {
    has_native_vcan && return
    check_packages "${emulator_packages[@]}"
    has_vcan_kernel && return
    echo "setup: this kernel has no vcan; to fetch: a kernel to emulate, into .cache/vcan (70 MB)"
    confirm
    tools/operate/vcan/kernel.sh
}

# What emulating a kernel lacks, where that is needed.
missing_vcan() {
    local tool
    for tool in candump cansend ip unshare; do
        command -v "$tool" >/dev/null || echo "$tool"
    done
    has_native_vcan && return
    for tool in busybox qemu-system-x86_64; do
        command -v "$tool" >/dev/null || echo "$tool"
    done
    has_vcan_kernel || echo "vcan in this kernel (or the kernel that tools/operate/vcan/kernel.sh fetches)"
}

has_module() {
    "$python" -c "import importlib.util, sys; sys.exit(importlib.util.find_spec('$1') is None)" 2>/dev/null
}

# missing_python NAME...: what tools/requirements-NAME.txt list, by the name of its module or program.
missing_python() {
    local python=${PYTHON:-} list package module program
    [ -n "$python" ] || python=$([ -x .venv/bin/python ] && echo .venv/bin/python || echo python3)
    command -v "$python" >/dev/null || {
        echo "$python"
        return
    }
    for list in "$@"; do
        grep -v '^#' "tools/requirements-$list.txt"
    done | sort -u | while read -r package _ module program; do
        if [ "$module" = program ]; then
            command -v "$program" >/dev/null || [ -x ".venv/bin/$program" ] || echo "$program"
        else
            has_module "${module:-${package%%==*}}" || echo "python module ${module:-${package%%==*}}"
        fi
    done
}

missing_programs() {
    local tool tools=(gcc ar pkg-config)
    ! wants python || tools+=(cmake)
    ! wants page || tools+=(clang wasm-ld)
    ! wants firmware || tools+=(arm-none-eabi-gcc qemu-system-arm)
    ! asks mcdc || tools+=(clang-19 llvm-cov-19)
    ! asks prove || tools+=(frama-c)
    ! wants test || tools+=(g++ clang cmake cppcheck riscv64-unknown-elf-gcc qemu-system-riscv32)
    for tool in "${tools[@]}"; do
        command -v "$tool" >/dev/null || echo "$tool"
    done
    ! wants test || has_browser || echo chromium
}

missing_libraries() {
    local library libraries=(ccd libconfig jansson nlopt)
    ! asks bench || libraries+=(igraph ompl)
    for library in "${libraries[@]}"; do
        pkg-config --exists "$library" 2>/dev/null || echo "$library"
    done
    # Debian's lcm.pc asks for GLib's headers, which LCM's do not include.
    gcc -E -include lcm/lcm.h -x c /dev/null >/dev/null 2>&1 || echo lcm
    ! wants test || riscv64-unknown-elf-gcc --specs=picolibc.specs -E -x c /dev/null >/dev/null 2>&1 ||
        echo "picolibc for RISC-V"
    ! wants page || clang --target=wasm32-wasi -E -include stdio.h -x c /dev/null >/dev/null 2>&1 || echo wasi-libc
    ! wants page || has_wasm_runtime || echo "clang's run-time library for wasm32"
}

# For people who manage their own packages.
report_missing() {
    local absent list
    mapfile -t absent < <(
        missing_programs
        missing_libraries
        ! wants vcan || missing_vcan
        missing_python "${requirements[@]}"
    )
    [ ${#absent[@]} -eq 0 ] && return
    printf -v list '%s, ' "${absent[@]}"
    die "JP_SETUP=skip, and missing: ${list%, }"
}

asks() {
    [[ " ${scopes[*]} " == *" $1 "* ]]
}

# wants SCOPE...: one of them was asked for, or test, which has them all.
wants() {
    local scope
    for scope in "$@" test; do
        ! asks "$scope" || return 0
    done
    return 1
}

yes=0
scopes=()
for argument in "$@"; do
    case $argument in
    --yes) yes=1 ;;
    sil | design | operate | campaign | python | page | mujoco | firmware | vcan | test | bench | mcdc | prove) scopes+=("$argument") ;;
    *) die "usage: tools/setup.sh [--yes] [sil|design|operate|campaign|python|page|mujoco|firmware|vcan|test|bench|mcdc|prove]..." ;;
    esac
done
[ ${#scopes[@]} -gt 0 ] || scopes=(test)

packages=("${sil_packages[@]}")
requirements=(sil)
! wants python || packages+=("${python_packages[@]}")
! wants page || packages+=("${page_packages[@]}")
! wants firmware || packages+=("${firmware_packages[@]}")
! wants vcan || packages+=("${vcan_packages[@]}")
! wants mujoco || packages+=("${mujoco_packages[@]}")
! wants test || packages+=("${test_packages[@]}")
! asks bench || packages+=("${bench_packages[@]}")
! asks mcdc || packages+=("${mcdc_packages[@]}")
! asks prove || packages+=("${prove_packages[@]}")
! wants design mujoco || requirements+=(design)
! wants operate vcan mujoco || requirements+=(operate)
! wants campaign || requirements+=(campaign)
! wants python || requirements+=(python)
! wants mujoco || requirements+=(mujoco)
! wants test || requirements+=(test)
if [ "${JP_SETUP:-}" = skip ]; then
    report_missing
    exit 0
fi
check_packages "${packages[@]}"
check_python "${requirements[@]}"
! wants vcan || check_vcan
