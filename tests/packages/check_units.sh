#!/bin/bash
# Starts the services under their sandboxes in a bare Debian 12, by a systemd of its own in namespaces of its own: docs/packages.md.
# By hand, as root, after `make deb`. BASE=FILE.tar as for check_packages.sh.
set -eu
cd "$(dirname "$0")/../.."
[ "$(id -u)" -eq 0 ] || { echo "check_units: run it as root" >&2; exit 3; }
ls packages/atrium-common_*.deb >/dev/null 2>&1 || { echo "check_units: no packages in packages/; run make deb first" >&2; exit 3; }
command -v mmdebstrap >/dev/null || { echo "check_units: needs mmdebstrap; run deploy/install_packages.sh container" >&2; exit 3; }

work=$(mktemp -d)
root=$work/root
mkdir "$root"
host=""
finish() {
    [ -z "$host" ] || kill -9 "$host" 2>/dev/null || true # systemd ends with its namespace
    wait
    rm -rf "$work"
}
trap finish EXIT
say() { echo "== $*"; }
fail() { echo "FAILED: $*" >&2; exit 1; }

say "a bare Debian 12 with systemd and the packages"
if [ -n "${BASE:-}" ]; then tar -C "$root" -xf "$BASE"; else mmdebstrap --quiet --variant=minbase --format=dir bookworm "$root"; fi
cp /etc/resolv.conf "$root/etc/resolv.conf"
mkdir "$root/deb" "$root/old"
cp packages/atrium-{common,site,world,viewer,tools}_*.deb "$root/deb/"
unshare --mount --pid --fork --kill-child bash -c '
    mount --bind /dev "$0/dev" && mount -t proc proc "$0/proc" && exec chroot "$0" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin \
        DEBIAN_FRONTEND=noninteractive sh -ec "apt-get update -qq; apt-get install -y -qq --no-install-recommends systemd iproute2 /deb/*.deb"
    ' "$root" < /dev/null > "$work/log" 2>&1 || { tail -n 20 "$work/log" >&2; fail "installation"; }
cp "$root"/usr/share/atrium/rigs/*.toml "$root/etc/atrium/rigs/"
cp "$root"/usr/share/atrium/sites/{alice,simulated_cameras}.toml "$root/etc/atrium/sites/"
echo 'unknown = 1' > "$root/etc/atrium/sites/wrong.toml"

cat > "$work/start" <<'EOF'
mount --make-rprivate / && mount --bind "$1" "$1" && mount --rbind /dev "$1/dev" && mount -t proc proc "$1/proc" &&
    mount -t tmpfs tmpfs "$1/run" && mount -t tmpfs -o mode=1777 tmpfs "$1/tmp" && mount -t sysfs sysfs "$1/sys" &&
    mount -t cgroup2 none "$1/sys/fs/cgroup" && cd "$1" && pivot_root . old && cd / &&
    exec env -i container=other PATH=/usr/sbin:/usr/bin bash -c 'umount -l /old; exec /lib/systemd/systemd --log-target=journal'
EOF
unshare --mount --pid --net --uts --ipc --cgroup --fork --kill-child bash "$work/start" "$root" < /dev/null > "$work/systemd.log" 2>&1 &
for _ in $(seq 50); do host=$(pgrep -P $! || true); [ -n "$host" ] && break; sleep 0.1; done
[ -n "$host" ] || { cat "$work/systemd.log" >&2; fail "namespaces are not permitted"; }

# Runs shell commands beside that systemd.
inside() {
    timeout --kill-after=2 120 nsenter -t "$host" --mount --pid --net --uts --ipc --cgroup --root --wd env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin \
        bash -euc "$1" < /dev/null
}
until_true() { # until_true SECONDS COMMANDS
    for _ in $(seq "$1"); do if inside "$2" > "$work/log" 2>&1; then return; fi; sleep 1; done
    cat "$work/log" >&2
    inside 'journalctl --no-pager -q -n 30' >&2 || true
    fail "not after $1 s: $2"
}
until_true 30 'systemctl is-system-running | grep -E "running|degraded"'
inside 'ip link set lo up; for i in 2 3 4 5 6 7 8 9; do ip addr add 127.0.0.$i/8 dev lo; done'

say "a world and a simulated room: rights, and metaframes"
inside 'systemctl start atrium-world atrium-site@alice'
until_true 60 'atrium monitor --once --wait 3 | tee /dev/stderr | grep -A 1 "^site alice" | grep -E "[1-9][0-9.]* metaframes/s"'
until_true 10 'atrium monitor --once --wait 3 | grep "^world server"'
for unit in atrium-world atrium-site@alice; do
    inside "grep -E '^(Uid|CapBnd|NoNewPrivs|Seccomp):' /proc/\$(systemctl show -P MainPID $unit)/status" | tr -s '\t\n' ' '
    echo "of $unit"
done
inside 'p=/proc/$(systemctl show -P MainPID atrium-world)/status; grep -q "^CapBnd:.0*$" $p; grep -q "^Seccomp:.2" $p'
inside 'p=/proc/$(systemctl show -P MainPID atrium-site@alice)/status; grep -q "^CapBnd:.0*2000$" $p; grep -q "^Seccomp:.2" $p'

say "a host with cameras and the model part of a site"
inside 'hostname north; systemctl stop atrium-site@alice
    cd /etc/atrium/sites; sed "s/^name = .*/name = \"hall\"/" alice.toml > hall.toml
    printf "[[host]]\nname = \"north\"\ncameras = \"auto\"\nmodel = true\n" >> hall.toml
    systemctl start atrium-camera@hall atrium-site@hall'
until_true 60 'atrium monitor --once --wait 3 | tee /dev/stderr | grep -A 1 "^site hall" | grep -E "[1-9][0-9.]* metaframes/s"'
inside 'p=/proc/$(systemctl show -P MainPID atrium-camera@hall)/status; grep -q "^CapBnd:.0*2000$" $p; grep -q "^Seccomp:.2" $p'
inside 'systemctl stop atrium-site@hall atrium-camera@hall; systemctl start atrium-site@alice'

say "a wrong configuration is not tried again"
inside 'systemctl start atrium-site@wrong' || true
until_true 10 'systemctl is-failed atrium-site@wrong'
inside 'test "$(systemctl show -P NRestarts -P ExecMainStatus atrium-site@wrong | tr "\n" " ")" = "0 2 "'

say "an upgrade restarts what runs and enables nothing"
before=$(inside 'systemctl show -P MainPID atrium-world atrium-site@alice')
inside 'dpkg -i /deb/*.deb' > "$work/log" 2>&1 || { cat "$work/log" >&2; fail "dpkg -i"; }
until_true 10 'systemctl is-active atrium-world atrium-site@alice'
for pid in $before; do ! inside "systemctl show -P MainPID atrium-world atrium-site@alice" | grep -qx "$pid" || fail "$pid still runs"; done
[ "$(inside 'systemctl is-enabled atrium-world || true')" = disabled ] || fail "the installation enabled atrium-world"
inside 'systemctl stop atrium-site@alice'

say "eight simulated cameras, which come after their site"
inside 'systemctl start atrium-site@simulated_cameras'
inside 'cd /root; systemd-run --unit=cameras --working-directory=/root atrium cameras --own_network false --empty_seconds 10 \
    --rig /usr/share/atrium/rigs/full_body_1mp.toml' > "$work/log" 2>&1
until_true 100 'atrium monitor --once --wait 3 | tee /dev/stderr | grep -A 1 "^site laboratory" | grep -E "[1-9][0-9.]* metaframes/s"'
inside 'atrium monitor --once --wait 3 | grep -A 1 "^site laboratory"; systemctl stop cameras'

say "purge stops the services and leaves no links"
inside 'systemctl enable atrium-world atrium-site@alice; dpkg --purge atrium-{tools,viewer,site,world,common}' > "$work/log" 2>&1 ||
    { cat "$work/log" >&2; fail "purge"; }
inside '! systemctl is-active --quiet atrium-world && ! systemctl is-active --quiet "atrium-site@*"'
left=$(inside 'find /etc/systemd /var/lib/systemd -name "*atrium*"')
[ -z "$left" ] || fail "purged, but there is still: $left"
echo "check_units: passed"
