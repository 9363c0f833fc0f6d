# Sourced by what deals with vcan interfaces: where the emulated kernel is kept and what counts as having vcan.
# shellcheck shell=bash

vcan_kernel=$PWD/.cache/vcan

# vcan_namespace COUNT COMMAND...: COMMAND in a network namespace of its own, with the interfaces vcan0 to
# vcan(COUNT-1) up and multicast on the loopback. Replaces the process.
vcan_namespace() {
    exec unshare --map-root-user --net bash -c '
        set -e
        ip link set lo up multicast on
        ip route add 224.0.0.0/4 dev lo
        for ((i = 0; i < $1; i++)); do
            ip link add "vcan$i" type vcan
            ip link set "vcan$i" up
        done
        shift
        exec "$@"' with_vcan "$@"
}

# Only a frame that was sent shows that the kernel has both the interface and the sockets.
has_native_vcan() {
    (vcan_namespace 1 cansend vcan0 123#) >/dev/null 2>&1
}

has_vcan_kernel() {
    [ -f "$vcan_kernel/vmlinux" ] && [ -f "$vcan_kernel/initramfs.gz" ] &&
        cmp -s tools/operate/vcan/init.sh "$vcan_kernel/init.sh"
}
