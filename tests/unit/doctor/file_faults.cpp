#include "core/keys/store.hpp"
#include "tests/unit/doctor/faults.hpp"

#include <sys/stat.h>
#include <time.h>

#include <array>

namespace atrium::doctor {
namespace {

// What openssl prints for a certificate that is valid between these days from now.
System::Output dates(int first_day, int last_day) {
    const auto day = [](int days) {
        const std::time_t time = std::time(nullptr) + std::time_t{days} * 86'400;
        std::tm date{};
        gmtime_r(&time, &date);
        std::array<char, 64> text{};
        strftime(text.data(), text.size(), "%b %d %H:%M:%S %Y GMT", &date);
        return std::string(text.data());
    };
    return {0, "notBefore=" + day(first_day) + "\nnotAfter=" + day(last_day) + "\n"};
}

Fault key_fault(const std::string& name,
                const std::string& id,
                const System::Output& output,
                const std::string& text,
                const std::string& cure) {
    return {name,
            id,
            [output](FakeHost& host, Options& options) {
                const auto file =
                    host.write_beside("keys/site.pem", "-----BEGIN CERTIFICATE-----\nMII\n");
                options.keys = file.parent_path();
                host.outputs["openssl x509 -in " + file.string() + " -noout -startdate -enddate"] =
                    output;
            },
            text,
            cure};
}

// A bundle that was made some days ago, for a number of days.
Fault bundle_fault(const std::string& name,
                   const std::string& id,
                   int days_ago,
                   int days,
                   mode_t mode,
                   const std::string& text,
                   const std::string& cure) {
    return {
        name,
        id,
        [=](FakeHost& host, Options& options) {
            const Timestamp made = Timestamp::now() + -std::chrono::hours(24 * days_ago);
            const auto file = host.write_beside("keys/alice.bundle", "");
            auto store = keys::KeyStore::create(
                file.parent_path().parent_path() / "playroom.keys", "playroom", 3650, made);
            const auto added = store->add({"playroom", keys::Kind::kSite, "alice", {}}, days, made);
            if (!added) throw std::runtime_error(added.error().message);
            host.write_beside("keys/alice.bundle",
                              keys::bundle_text(store->bundle("alice").value()));
            ::chmod(file.c_str(), mode);
            options.keys = file.parent_path();
        },
        text,
        cure};
}

std::vector<Fault> key_faults() {
    return {
        bundle_fault("BundleExpired",
                     "key_expired",
                     100,
                     30,
                     0600,
                     "The key of site alice of world playroom in ",
                     "atrium keys renew alice"),
        bundle_fault("BundleExpiresSoon",
                     "key_expires_soon",
                     100,
                     110,
                     0600,
                     "export it and bring it here",
                     "atrium keys renew alice"),
        bundle_fault(
            "OpenBundle", "bundle_not_usable", 1, 300, 0644, "others can read it", "chmod 600 "),
        {"FileThatIsNoBundle",
         "bundle_not_usable",
         [](FakeHost& host, Options& options) {
             options.keys = host.write_beside("etc/passwd", "root:x:0:0:root:/root:/bin/sh\n");
         },
         "is no bundle of keys",
         "atrium keys export NAME -o NAME.bundle"},
        key_fault("KeyExpired",
                  "key_expired",
                  dates(-400, -35),
                  "expired 36 days ago",
                  "openssl x509 -x509toreq -in "),
        key_fault("KeyExpiresSoon",
                  "key_expires_soon",
                  dates(-300, 7),
                  "expires in 6 days",
                  "openssl x509 -x509toreq -in "),
        key_fault("KeyNotYetValid",
                  "key_not_yet_valid",
                  dates(3, 300),
                  "is valid only in 3 days",
                  "sudo timedatectl set-ntp true"),
        key_fault("NoOpenssl",
                  "openssl_missing",
                  {127, ""},
                  "unknown without openssl",
                  "sudo apt install openssl"),
        {"BundleRevokedByTheStoreBesideIt",
         "bundle_not_usable",
         [](FakeHost& host, Options& options) {
             const Timestamp now = Timestamp::now();
             const auto file = host.write_beside("keys/alice.bundle", "");
             auto store = keys::KeyStore::create(
                 file.parent_path() / "playroom.keys", "playroom", 3650, now);
             (void)store->add({"playroom", keys::Kind::kSite, "alice", {}}, 365, now);
             host.write_beside("keys/alice.bundle",
                               keys::bundle_text(store->bundle("alice").value()));
             ::chmod(file.c_str(), 0600);
             (void)store->revoke("alice", keys::Reason::kLost, now);
             options.keys = file;
         },
         "is revoked, says ",
         "atrium keys renew alice --keys "},
        {"NeitherBundleNorFolderOfKeys",
         "keys_missing",
         [](FakeHost& host, Options& options) {
             const auto file = host.write_beside("keys/alice.bundle", "");
             options.keys = file.parent_path() / "alice";
         },
         "alice.bundle? Give the path of one",
         "sudo find /home /root /etc -name '*.bundle' -o -name '*.invitation'"},
        {"KeysMissing",
         "keys_missing",
         [](FakeHost& host, Options& options) { options.keys = host.folder() / "no_keys" / ""; },
         "is not there",
         "sudo mkdir -m 700 -p "},
        {"KeysMissingWithTheGroupOfServices",
         "keys_missing",
         [](FakeHost& host, Options& options) {
             host.install();
             options.keys = host.folder() / "no_keys" / "";
         },
         "is not there",
         "sudo install -d -m 0750 -o root -g atrium "},
        {"PrivateKeyThatItsGroupMayWrite",
         "private_key_readable",
         [](FakeHost& host, Options&) {
             host.write("/etc/atrium/keys/site_key.pem", "-----BEGIN PRIVATE KEY-----\n", 0660);
         },
         "Other users may read or write the private key",
         "sudo chmod o-rwx,g-w "},
        {"OpenPrivateKey",
         "private_key_readable",
         [](FakeHost& host, Options&) {
             host.write("/etc/atrium/keys/site_key.pem",
                        "-----BEGIN PRIVATE KEY-----\nx\n-----END PRIVATE KEY-----\n",
                        0644);
         },
         "Other users may read or write the private key",
         "sudo chmod o-rwx,g-w "}};
}

std::vector<Fault> folder_faults() {
    return {{"RecordingsClosed",
             "folder_not_writable",
             [](FakeHost& host, Options& options) {
                 options.recordings = host.folder();
                 host.disk_mb_per_s = make_error(ErrorKind::kUnavailable, "Permission denied");
             },
             "cannot be written: Permission denied",
             "sudo install -d -o lab "},
            {"CacheClosed",
             "cache_not_writable",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_site();
                 FakeHost::name_cache(options.file, "/srv/kept");
                 host.disk_mb_per_s = make_error(ErrorKind::kUnavailable, "Read-only file system");
             },
             "Read-only file system",
             "sudo mount -o remount,rw \"$(findmnt -n -o TARGET -T "},
            {"CacheOfAnother",
             "cache_not_writable",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_site();
                 FakeHost::name_cache(options.file, "/srv/kept");
                 host.disk_mb_per_s = make_error(ErrorKind::kUnavailable, "Permission denied");
             },
             "folder /srv/kept cannot be written (Permission denied)",
             "sudo install -d -o lab /srv/kept"},
            {"DiskFull",
             "disk_full",
             [](FakeHost& host, Options& options) {
                 options.recordings = host.folder();
                 host.disk_free = std::uint64_t{3} << 30U;
             },
             "has 3 GiB left; wanted are 10 GiB",
             "sudo du -xh --max-depth=2 "},
            {"DiskSlow",
             "disk_slow",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_site();
                 options.recordings = host.folder();
                 host.disk_mb_per_s = 31.4;
             },
             "writes 31 MB/s; a recording wants 60",
             "lsblk"}};
}

std::vector<Fault> program_faults() {
    return {{"ProgramMissing",
             "program_missing",
             [](FakeHost& host, Options& options) {
                 std::filesystem::remove(host.programs() / "world_server");
                 options.roles = Roles{.world = true};
             },
             "The program world_server is missing in ",
             "deploy/build.sh build && sudo cp -r build/bin/. "},
            {"ProgramMissingOfThePackages",
             "program_missing",
             [](FakeHost& host, Options& options) {
                 host.install();
                 std::filesystem::remove(host.programs() / "world_server");
                 options.roles = Roles{.world = true};
             },
             "/usr/lib/atrium/bin. The command takes the files of make deb.",
             "sudo apt install ./packages/atrium-common_*.deb ./packages/atrium-world_*.deb"},
            {"ProgramMissingOfAnInstallationByHand",
             "program_missing",
             [](FakeHost& host, Options& options) {
                 host.install();
                 host.remove("/usr/share/doc/atrium-common");
                 std::filesystem::remove(host.programs() / "world_server");
                 options.roles = Roles{.world = true};
             },
             "The program world_server is missing in ",
             "deploy/build.sh build && sudo cp -r build/bin/. "},
            {"VersionsMixedOfThePackages",
             "versions_mixed",
             [](FakeHost& host, Options&) {
                 host.install();
                 host.outputs["monitor --version"] = {0, "monitor 0.2.0 (Atrium)\n"};
             },
             "and 0.2.0 (monitor): they do not understand each other. The command takes",
             "sudo apt install ./packages/atrium-common_*.deb ./packages/atrium-site_*.deb "
             "./packages/atrium-tools_*.deb ./packages/atrium-viewer_*.deb "
             "./packages/atrium-world_*.deb"},
            {"LibraryMissing",
             "library_missing",
             [](FakeHost& host, Options&) {
                 host.outputs["viewer --version"] = {127, "error while loading\n"};
                 host.outputs["ldd " + (host.programs() / "viewer").string()] = {
                     0,
                     "\tlibglfw.so.3 => not found\n\tlibfmt.so.9 => /lib/libfmt.so.9 (0x7f)\n"
                     "\tlibstb.so.0 => not found\n"};
             },
             "viewer does not start: missing libglfw.so.3, libstb.so.0",
             "sudo apt install libglfw3 libstb0"},
            {"UnknownLibraryMissing",
             "library_missing",
             [](FakeHost& host, Options&) {
                 host.outputs["viewer --version"] = {127, "error while loading\n"};
                 host.outputs["ldd " + (host.programs() / "viewer").string()] = {
                     0, "\tlibodd.so.4 => not found\n"};
             },
             "libodd.so.4",
             "apt-file search libodd.so.4"},
            {"VersionsMixed",
             "versions_mixed",
             [](FakeHost& host, Options&) {
                 host.outputs["viewer --version"] = {0, "viewer 0.2.0 (Atrium)\n"};
             },
             "0.1.0 (site_node, camera_node, world_server, monitor) and 0.2.0 (viewer)",
             "deploy/build.sh build"},
            {"RigMissing",
             "rig_unusable",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_site();
                 std::filesystem::remove(host.folder() / "rig.toml");
             },
             "rig.toml",
             "site.toml -o /"},
            {"RigOfTheServiceMissing",
             "rig_unusable",
             [](FakeHost& host, Options& options) {
                 options.file = host.install();
                 host.remove("/etc/atrium/sites/rig.toml");
             },
             "rig.toml",
             "sudo atrium calibrate wand --config /"},
            {"RecordingMissing",
             "recording_missing",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_beside(
                     "site.toml", "[capture]\nsource = \"recording\"\nrecording = \"nowhere\"\n");
             },
             "nowhere",
             "grep -n recording "},
            {"NiceNotPermitted",
             "nice_not_permitted",
             [](FakeHost& host, Options& options) {
                 options.file = host.write_beside("world.toml", "[process]\nnice = -5\n");
             },
             "is -5; lab may use 20 at the lowest",
             "echo 'lab - nice -5' | sudo tee /etc/security/limits.d/61-atrium-nice.conf"},
            {"FewCores",
             "cores_too_few",
             [](FakeHost& host, Options& options) {
                 host.write_site();  // for its rig
                 host.write("/sys/devices/system/cpu/online", "0-1,3\n");
                 options.file = host.write_beside(
                     "room.toml", "[capture]\nrig = \"rig.toml\"\nrate_hz = 1000\n");
             },
             "2000 megapixels/s (2 cameras at 1000 Hz) need about 6.0 cores; this host has 3",
             "--capture.rate_hz 500"}};
}

}  // namespace

std::vector<Fault> file_faults() {
    std::vector<Fault> faults = program_faults();
    for (std::vector<Fault> more : {folder_faults(), key_faults()})
        std::move(more.begin(), more.end(), std::back_inserter(faults));
    return faults;
}

}  // namespace atrium::doctor
