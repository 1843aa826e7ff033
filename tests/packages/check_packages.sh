#!/bin/bash
# Installs the packages of packages/ into a bare Debian 12, runs the demo and a site on several hosts there, upgrades, removes and purges
# them: docs/packages.md.
# By hand, as root, after `make deb`; it takes some minutes and loads packages of Debian. BASE=FILE.tar uses a root made before:
#   mmdebstrap --variant=minbase bookworm FILE.tar
set -eu
cd "$(dirname "$0")/../.."
[ "$(id -u)" -eq 0 ] || { echo "check_packages: run it as root" >&2; exit 3; }
ls packages/atrium-common_*.deb >/dev/null 2>&1 || { echo "check_packages: no packages in packages/; run make deb first" >&2; exit 3; }
command -v mmdebstrap >/dev/null || { echo "check_packages: needs mmdebstrap; run deploy/install_packages.sh container" >&2; exit 3; }
names="common site world viewer tools"
commands=$(sed -n 's/^ *{*{"\([a-z]*\)", ".*/\1/p' tools/atrium/commands.cpp)
[ "$(wc -w <<< "$commands")" -ge 15 ] || { echo "check_packages: tools/atrium/commands.cpp: its list of commands is not understood" >&2; exit 3; }

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
root=$work/root
mkdir "$root"

say() { echo "== $*"; }
fail() { echo "FAILED: $*" >&2; exit 1; }

# Runs shell commands in the root, with /dev and /proc in a mount namespace that ends with them.
inside() {
    unshare --mount --pid --fork --kill-child bash -c '
        mount --bind /dev "$0/dev" && mount -t proc proc "$0/proc" && exec chroot "$0" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin \
            HOME=/root LC_ALL=C.UTF-8 DEBIAN_FRONTEND=noninteractive bash -euc "$1"' "$root" "$1" < /dev/null
}
quietly() { "$@" > "$work/log" 2>&1 || { tail -n 40 "$work/log" >&2; fail "$*"; }; }
expect() { inside "$1" > "$work/log" 2>&1 || { tail -n 20 "$work/log" >&2; fail "$1"; }; }
# confdef: without an answer, dpkg keeps a file of the configuration that was edited
install_all() { quietly inside "apt-get install -y --no-install-recommends -o Dpkg::Options::=--force-confdef $1/*.deb"; }

say "a bare Debian 12"
if [ -n "${BASE:-}" ]; then tar -C "$root" -xf "$BASE"; else quietly mmdebstrap --variant=minbase --format=dir bookworm "$root"; fi
cp /etc/resolv.conf "$root/etc/resolv.conf"

say "two versions of the packages: the second is the first with a higher version and another world.toml"
mkdir "$root/first" "$root/second"
for name in $names; do
    deb=$(ls packages/atrium-"$name"_*.deb)
    cp "$deb" "$root/first/"
    dpkg-deb -R "$deb" "$work/unpacked"
    version=$(sed -n 's/^Version: //p' "$work/unpacked/DEBIAN/control")
    sed -i "s/$(printf %s "$version" | sed 's/[.+]/\\&/g')/$version+1/" "$work/unpacked/DEBIAN/control"
    if [ "$name" = world ]; then echo "# of the second version" >> "$work/unpacked/etc/atrium/world.toml"; fi
    quietly dpkg-deb --root-owner-group -b "$work/unpacked" "$root/second/atrium-$name.deb"
    rm -rf "$work/unpacked"
done

say "install"
quietly inside "apt-get update -qq"
install_all /first
expect 'id atrium'
expect 'test "$(stat -c "%a %U %G" /etc/atrium/keys)" = "750 root atrium"'
for name in $commands; do
    expect "atrium help | grep -q '^  $name '"
    expect "atrium $name --version"
    expect "atrium-$name --help"
    expect "test -s /usr/share/man/man1/atrium-$name.1.gz"
    expect ". /usr/share/bash-completion/completions/atrium
        COMP_WORDS=(atrium $name --versio) COMP_CWORD=2
        _atrium
        test \"\${COMPREPLY[*]}\" = --version"
done
expect 'cd /usr/share/atrium && atrium hull views/person.json -o /tmp/person.ply && test -s /tmp/person.ply'

say "the world of the service finds its models"
expect 'install -d -o atrium /var/lib/atrium /var/cache/atrium
    cd /var/lib/atrium
    setpriv --reuid=atrium --regid=atrium --clear-groups --no-new-privs --bounding-set=-all --inh-caps=-all \
        timeout --signal=INT --preserve-status 4 /usr/lib/atrium/bin/world_server --config /etc/atrium/world.toml \
        --world.state_file /var/lib/atrium/world.state
    test -s /var/lib/atrium/world.state'
grep -q "missing\|not found" "$work/log" && { cat "$work/log"; fail "the world server misses something"; }

say "the demo"
cp debian/tests/demo "$root/root/demo"
expect 'AUTOPKGTEST_TMP=/tmp /root/demo'
grep "rate   ms" -A 4 "$work/log" | tail -n 5

say "a site on several hosts"
cp debian/tests/site-hosts "$root/root/site-hosts"
expect 'AUTOPKGTEST_TMP=/tmp /root/site-hosts'
grep " metaframes/s" "$work/log" | tail -n 1

say "a site whose hosts do not answer"
expect '! atrium status /usr/share/atrium/sites/hall.toml --patience 5 > /tmp/said 2>&1
    for host in north east south west hull; do grep -q "^$host: .*ssh" /tmp/said; done'

say "the doctor"
expect 'atrium doctor --for site,world,viewer --network loopback --json > /tmp/found || [ $? -eq 1 ]
    ! grep -E "program_missing|library_missing|versions_mixed" /tmp/found
    grep -q "\"healthy\"" /tmp/found'

say "upgrade: what the administrator edited or added stays"
inside 'echo "# edited here" >> /etc/atrium/world.toml
    cp /usr/share/atrium/sites/alice.toml /etc/atrium/sites/studio.toml
    touch /etc/atrium/keys/own.pem; chmod 0700 /etc/atrium/keys'
install_all /second
expect 'dpkg-query -W -f "\${Version}\n" atrium-site | grep -q "+1$"'
expect 'grep -q "edited here" /etc/atrium/world.toml'
expect '! grep -q "of the second version" /etc/atrium/world.toml'
expect 'grep -q "of the second version" /etc/atrium/world.toml.dpkg-dist'
expect 'test -f /etc/atrium/sites/studio.toml -a -f /etc/atrium/keys/own.pem'
expect 'test "$(stat -c %a /etc/atrium/keys)" = 700'
expect 'atrium world --version'

all=$(printf 'atrium-%s ' $names)
say "remove: the configuration stays"
quietly inside "apt-get remove -y $all"
expect '! command -v atrium && test ! -e /usr/lib/atrium -a ! -e /usr/share/atrium'
expect 'grep -q "edited here" /etc/atrium/world.toml && test -d /var/lib/atrium'

say "purge: only files that the administrator added stay"
quietly inside "dpkg --purge $all"
expect 'test ! -e /etc/atrium/world.toml -a ! -e /var/lib/atrium -a ! -e /var/cache/atrium'
expect 'test -f /etc/atrium/sites/studio.toml -a -f /etc/atrium/keys/own.pem'

say "install again, and purge without files of the administrator"
inside 'rm -rf /etc/atrium /tmp/* /tmp/.cache'
install_all /first
quietly inside "dpkg --purge $all"
left=$(find "$root" -xdev -name '*atrium*' -not -path "$root/first/*" -not -path "$root/second/*" -not -path "$root/var/cache/apt/*")
[ -z "$left" ] || fail "purged, but there is still: $left"
echo "check_packages: passed"
