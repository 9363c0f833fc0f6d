#!/usr/bin/env bash
# Runs a command where SocketCAN works: with_vcan.sh [--interfaces N] -- COMMAND...
# COMMAND finds vcan0 to vcan(N-1) up and multicast on the loopback, in a network namespace of its own: natively where
# the kernel has vcan, else in an emulated one. That one sees the same files and environment, but no standard input and
# another TMPDIR, in memory, because sockets cannot be shared; what it writes shows outside when COMMAND has ended.
# The exit status is that of COMMAND; 2: no vcan, or the emulated kernel failed.
set -uo pipefail
caller_folder=$PWD
cd "$(dirname "$0")/../.." || exit 2
. tools/operate/vcan/common.sh

boot_limit=120 # s; 4 s on an idle machine
interfaces_limit=16
log=${JP_BUILD:-$PWD/build}/with_vcan.log

die() {
    echo "with_vcan: $*" >&2
    exit 2
}

needs() {
    local tool
    for tool in "$@"; do
        command -v "$tool" >/dev/null || die "no $tool here: run tools/setup.sh vcan"
    done
}

# The job as a script of bash: where, in which environment, what. It stays: process 1, which it is, takes no signals.
write_job() {
    id -G | tr ' ' ',' | sed "s/^/$(id -u) $(id -g) /" >"$job/user"
    {
        echo 'exec 9<&-'
        echo "umask $(umask)"
        export -p
        echo 'export TMPDIR=/dev/shm'
        printf 'cd %q || exit 2\n' "$caller_folder"
        declare -f vcan_namespace
        echo 'exec 8>&2 2>/dev/null' # keeps bash from reporting signals
        printf '(exec 2>&8 8>&-; vcan_namespace'
        printf ' %q' "$interfaces" "$@"
        printf ')\nexit $?\n'
    } >"$job/command"
}

# Replaces the process. Traps do not see SIGKILL. A script that was killed before this one asked to die with it is no
# longer its parent.
dies_with_script() {
    # shellcheck disable=SC2016
    exec setpriv --pdeathsig KILL sh -c '[ "$PPID" -eq "$0" ] && exec "$@"' $$ "$@"
}

# Paths in the options are relative: a comma in one would end it. One processor: between two of them a turn of frames
# would wait for the other to wake, five times as long, or both would have to poll where they are idle.
start_emulator() {
    cd "$job" || exit
    dies_with_script qemu-system-x86_64 -nodefaults -no-user-config -display none -no-reboot \
        -machine q35 -accel tcg,thread=multi,tb-size=512 -cpu max -smp 1 -m 2G \
        -kernel "$vcan_kernel/vmlinux" -initrd "$vcan_kernel/initramfs.gz" \
        -append 'console=ttyS0 quiet panic=-1 mitigations=off no_timer_check' \
        -chardev file,id=console,path=boot.log,append=on -serial chardev:console \
        -fsdev local,id=host,path=/,security_model=none,multidevs=remap \
        -device virtio-9p-pci,fsdev=host,mount_tag=host \
        -fsdev local,id=job,path=.,security_model=none \
        -device virtio-9p-pci,fsdev=job,mount_tag=job \
        -device virtio-rng-pci -device virtio-serial-pci \
        -chardev file,id=stdout,path=stdout -device virtserialport,chardev=stdout,nr=1 \
        -chardev file,id=stderr,path=stderr -device virtserialport,chardev=stderr,nr=2
}

stop_emulator() {
    local processes
    exec 2>/dev/null # keeps bash from reporting the signal
    mapfile -t processes < <(jobs -p)
    [ ${#processes[@]} -eq 0 ] || kill -KILL "${processes[@]}"
    rm -rf "$job"
}

# The boot log outlives the job; why the kernel gave up, or else its end, explains most failures.
emulator_failed() {
    mkdir -p "$(dirname "$log")"
    cp "$job/boot.log" "$log"
    grep -m 1 'Kernel panic' "$log" >&2 || tail -n 5 "$log" >&2
    die "the emulated kernel $1; its messages: $log"
}

wait_for_boot() {
    local end=$((SECONDS + boot_limit))
    until [ -e "$job/booted" ]; do
        kill -0 "$emulator" 2>/dev/null || emulator_failed "ended before it had booted"
        [ "$SECONDS" -lt "$end" ] || emulator_failed "did not boot within $boot_limit s"
        sleep 0.1
    done
}

# One at a time: each keeps a processor busy, and side by side they take longer than in turn.
wait_for_turn() {
    exec 7<"$vcan_kernel/vmlinux"
    flock --nonblock 7 && return
    echo "with_vcan: waits for another emulated kernel to end" >&2
    flock 7
}

run_emulated() {
    local emulator
    needs qemu-system-x86_64 busybox setpriv
    has_vcan_kernel || die "this kernel has no vcan, and .cache/vcan holds none to emulate: run tools/setup.sh vcan"
    wait_for_turn
    echo "with_vcan: this kernel has no vcan; emulating one that has" >&2
    job=$(mktemp -d) || die "mktemp failed: check TMPDIR"
    trap stop_emulator EXIT
    trap 'exit 129' HUP
    trap 'exit 130' INT
    trap 'exit 143' TERM
    write_job "$@"
    mkfifo "$job/stdout" "$job/stderr"
    dies_with_script cat "$job/stdout" &
    dies_with_script cat "$job/stderr" >&2 &
    start_emulator </dev/null >"$job/boot.log" 2>&1 &
    emulator=$!
    wait_for_boot
    wait
    [ -s "$job/status" ] || emulator_failed "broke down while the command ran"
    exit "$(cat "$job/status")"
}

usage() {
    die "usage: tools/operate/with_vcan.sh [--interfaces N] -- COMMAND...; N from 1 to $interfaces_limit"
}

interfaces=1
if [ "${1:-}" = --interfaces ]; then
    interfaces=${2:-}
    shift 2 || usage
    [[ $interfaces =~ ^[1-9][0-9]?$ ]] && [ "$interfaces" -le "$interfaces_limit" ] || usage
fi
[ "${1:-}" = -- ] && [ $# -ge 2 ] || usage
shift

needs ip unshare cansend
if has_native_vcan; then
    echo "with_vcan: vcan of this kernel" >&2
    cd "$caller_folder" || exit 2
    vcan_namespace "$interfaces" "$@"
fi
run_emulated "$@"
