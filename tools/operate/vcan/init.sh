#!/bin/busybox sh
# Process 1 of the emulated kernel: runs the job of with_vcan.sh among the files of the host.
/bin/busybox --install -s /bin
export PATH=/bin
mount -t devtmpfs dev /dev
mount -t proc proc /proc
mount -t sysfs sys /sys
modprobe -a virtio_pci virtio_console 9p 9pnet_virtio virtio-rng vcan can-raw can-bcm

share() {
    mount -t 9p -o "trans=virtio,version=9p2000.L,msize=512000,access=any,cache=$3" "$1" "$2"
}

# The port appears some time after its driver.
port() {
    until [ -c /dev/vport*p"$1" ]; do
        usleep 10000
    done
    echo /dev/vport*p"$1"
}

# In a process namespace, so that nothing that the job started outlives it and holds its output open. The job is read
# through a descriptor: its path lies outside the root directory. That directory is moved, because in one that was only
# changed to there are no user namespaces.
run_job() {
    read -r user group groups </job/user
    unshare --mount --pid --fork sh -c '
        mount -t proc proc /host/proc
        cd /host && mount --move . /
        exec chroot . /usr/bin/setpriv --reuid="$0" --regid="$1" --groups="$2" /bin/bash /proc/self/fd/9' \
        "$user" "$group" "$groups" 9</job/command </dev/null >/stdout 2>/stderr
}

mkdir /host /job
share job /job none
# Nobody else writes these files meanwhile, and Python starts twice as fast with a cache.
share host /host loose
mount -t sysfs sys /host/sys
mount --bind /dev /host/dev
mkdir /dev/pts /dev/shm
mount -t devpts -o mode=620,ptmxmode=666 devpts /dev/pts
mount -t devpts -o mode=620,ptmxmode=666 devpts /host/dev/pts
mount -t tmpfs -o mode=1777 shm /host/dev/shm
ln -sf pts/ptmx /dev/ptmx
ln -s /proc/self/fd /dev/fd
ln -s fd/0 /dev/stdin
ln -s fd/1 /dev/stdout
ln -s fd/2 /dev/stderr

# A port can be opened only once; programs may open /dev/stdout again.
mkfifo /stdout /stderr
chmod 666 /stdout /stderr
cat /stdout >"$(port 1)" &
cat /stderr >"$(port 2)" &
touch /job/booted
run_job
status=$?
wait
sync
echo "$status" >/job/status
poweroff -f
