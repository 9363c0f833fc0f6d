#!/usr/bin/env bash
# Puts a kernel that has vcan into .cache/vcan, for with_vcan.sh: Debian's newest, unpacked and not installed.
# Called by tools/setup.sh. Exit status 2: it could not be fetched; what was there stays.
set -Eeuo pipefail
cd "$(dirname "$0")/../../.."
. tools/operate/vcan/common.sh

# With what these need: virtio for the host's files and the output, and CAN.
modules=(drivers/virtio drivers/char/virtio_console drivers/char/hw_random/virtio-rng
    net/9p fs/9p fs/netfs fs/fscache net/can drivers/net/can/dev drivers/net/can/vcan)

die() {
    echo "setup: $*" >&2
    exit 2
}

# The metapackage names the newest kernel.
download_package() {
    local package
    package=$(apt-cache depends linux-image-amd64 2>/dev/null |
        sed -n 's/.*Depends: \(linux-image-[0-9].*-amd64\)$/\1/p')
    [ -n "$package" ] && (cd "$work" && apt-get download -q "$package" >/dev/null 2>&1)
}

update_lists() {
    if [ "$(id -u)" -eq 0 ]; then
        apt-get update -q >/dev/null 2>&1
    else
        sudo apt-get update -q >/dev/null 2>&1
    fi
}

# Unpacked here, because the emulated processor takes 3 s for it at each boot.
unpack_image() {
    local start
    start=$(LC_ALL=C grep -abo -P '\xfd7zXZ(?=\x00)' "$1" | cut -d : -f 1 | sed -n 1p)
    tail -c "+$((start + 1))" "$1" >"$work/image.xz"
    xz --decompress --single-stream <"$work/image.xz" >"$work/new/vmlinux"
}

make_initramfs() {
    local version=$1 from="$work/package/lib/modules/$1" to="$work/initramfs/lib/modules/$1" path
    mkdir -p "$work"/initramfs/{bin,dev,proc,sys} "$to"
    cp "$(command -v busybox)" "$work/initramfs/bin/"
    cp tools/operate/vcan/init.sh "$work/initramfs/init"
    chmod 755 "$work/initramfs/init"
    cp "$from"/modules.{order,builtin} "$to"
    for path in "${modules[@]}"; do
        mkdir -p "$to/kernel/${path%/*}"
        cp -r "$from/kernel/$path"* "$to/kernel/${path%/*}/"
    done
    busybox depmod -b "$work/initramfs" "$version"
    (cd "$work/initramfs" && find . | busybox cpio -o -H newc 2>/dev/null | gzip) >"$work/new/initramfs.gz"
}

unpack_package() {
    local version
    dpkg -x "$work"/linux-image-*.deb "$work/package" 2>/dev/null
    version=$(basename "$work"/package/lib/modules/*)
    mkdir "$work/new"
    unpack_image "$work/package/boot/vmlinuz-$version"
    make_initramfs "$version"
    cp tools/operate/vcan/init.sh "$work/new/"
}

mkdir -p .cache
work=$(mktemp -d .cache/vcan.XXXXXX)
trap 'rm -rf "$work"' EXIT
work=$PWD/$work
download_package || { update_lists && download_package; } ||
    die "no kernel with vcan: apt-get download of Debian's linux-image-amd64 failed; or make vcan work here:" \
        "sudo modprobe vcan (Ubuntu: package linux-modules-extra-$(uname -r))"
trap 'die "could not unpack $(basename "$work"/*.deb) under .cache: is the disk full?"' ERR
unpack_package
rm -rf "$vcan_kernel"
mv "$work/new" "$vcan_kernel"
