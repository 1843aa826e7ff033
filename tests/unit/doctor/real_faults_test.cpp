#include "tests/support/fake_gige_camera.hpp"
#include "tests/support/network/own_network.hpp"
#include "tests/support/run_program.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"
#include "tests/unit/doctor/fake_host.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

// The real program on this real system: each fault is provoked, found, and mended by the command
// that the finding names. Networks and mounts are private to this test.
namespace atrium::doctor {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;
using test_support::Outcome;
using test_support::run_program;
using testing::HasSubstr;

constexpr int kLimit_s = 120;
const std::string kDoctor = ATRIUM_BIN_DIR "/doctor";

class RealFaults : public testing::Test {
protected:
    void SetUp() override {
        const auto* const test = testing::UnitTest::GetInstance()->current_test_info();
        folder_ = fs::path(testing::TempDir()) / ("atrium_real_" + std::to_string(getpid())) /
                  test->name();
        fs::remove_all(folder_);
        fs::create_directories(folder_ / "bin");
    }
    void TearDown() override {
        std::error_code ignored;
        fs::remove_all(folder_, ignored);
    }

    // Runs shell commands in a mount namespace of their own, in which /sys shows our network.
    Outcome shell(const std::string& commands) const {
        const std::string script = (folder_ / "commands.sh").string();
        std::ofstream(script) << "mount -t sysfs sysfs /sys || exit 99\n" << commands << "\n";
        return run_program("unshare -m sh " + script, kLimit_s);
    }
    std::string doctor(const std::string& arguments) const {
        return kDoctor + " --json --programs " + (folder_ / "bin").string() + " " + arguments;
    }
    // The finding `id`; null if it is not there.
    static json finding(const Outcome& outcome, const std::string& id) {
        const std::size_t begin = outcome.output.find("{\n");
        const json report = json::parse(
            begin == std::string::npos ? "" : outcome.output.substr(begin), nullptr, false);
        EXPECT_TRUE(report.is_object()) << outcome.output;
        if (!report.is_object()) return nullptr;
        for (const json& one : report["findings"]) {
            if (one["id"] == id) return one;
        }
        return nullptr;
    }
    // Provokes a fault by `commands`, expects it to be found, runs its cure and expects it to be
    // gone.
    void expect_cured(const std::string& commands,
                      const std::string& id,
                      const std::string& arguments = "--for world") const {
        const Outcome ill = shell(commands + "\n" + doctor(arguments));
        const json found = finding(ill, id);
        ASSERT_FALSE(found.is_null()) << ill.output;
        EXPECT_EQ(ill.exit_code, found["severity"] == "note" ? ill.exit_code : 1);
        const std::string cure = found["cure"];
        const Outcome well =
            shell(commands + "\n" + cure + " >/dev/null || exit 98\n" + doctor(arguments));
        EXPECT_TRUE(finding(well, id).is_null()) << cure << "\n" << well.output;
    }
    // A card "veth0" with an address, whose cable ends in "veth1".
    void make_card() const {
        run_program("ip link del veth0 2>/dev/null; true", kLimit_s);
        const Outcome made = run_program(
            "sh -c 'ip link add veth0 type veth peer name veth1 && ip addr add 10.9.0.1/24 dev "
            "veth0 && ip link set veth0 up && ip link set veth1 up'",
            kLimit_s);
        is_card_made_ = made.exit_code == 0;
        reason_ = made.output;
    }
    void add_program(const std::string& name, const std::string& script) const {
        std::ofstream(folder_ / "bin" / name) << "#!/bin/sh\n" << script << "\n";
        fs::permissions(folder_ / "bin" / name, fs::perms::owner_all);
    }

    fs::path folder_;
    mutable bool is_card_made_ = false;
    mutable std::string reason_;
};

class RealNetworkFaults : public RealFaults {
protected:
    void SetUp() override {
        RealFaults::SetUp();
        const std::string& reason = test_support::reason_without_own_network();
        if (!reason.empty()) GTEST_SKIP() << atrium::test::skip::kNoNetwork << reason;
        if (shell("exit 0").exit_code != 0)
            GTEST_SKIP() << atrium::test::skip::kNoNetwork << "sysfs cannot be mounted";
        make_card();
        if (!is_card_made_) GTEST_SKIP() << atrium::test::skip::kNoNetwork << reason_;
    }
    void TearDown() override {
        run_program("sh -c 'ip link del veth0; ip link set lo mtu 65536'", kLimit_s);
        RealFaults::TearDown();
    }
};

TEST_F(RealNetworkFaults, CardWithoutMulticast) {
    expect_cured("ip link set veth0 multicast off", "card_without_multicast");
}

TEST_F(RealNetworkFaults, NoMulticastRoute) {
    expect_cured("ip route del 224.0.0.0/4 2>/dev/null; ip route del default 2>/dev/null",
                 "no_multicast_route");
}

TEST_F(RealNetworkFaults, FragmentsKeptLong) {
    if (run_program("sysctl --version", kLimit_s).exit_code != 0)
        GTEST_SKIP() << atrium::test::skip::kNoNetwork << "sysctl is not installed";
    expect_cured("echo 30 > /proc/sys/net/ipv4/ipfrag_time", "fragments_kept_long");
}

TEST_F(RealNetworkFaults, CardsInOneSubnet) {
    expect_cured(
        "ip addr flush dev veth0; ip addr add 10.9.0.1/24 dev veth0; ip addr add 10.9.0.2/24 dev "
        "veth1",
        "cards_in_one_subnet");
}

TEST_F(RealNetworkFaults, NoNetworkCard) {
    const Outcome ill =
        shell("ip link set veth0 down\nip link set veth1 down\n" + doctor("--for world"));
    const json found = finding(ill, "no_network_card");
    ASSERT_FALSE(found.is_null()) << ill.output;
    EXPECT_THAT(found["cure"].get<std::string>(), HasSubstr("ip link set dev veth"));
    EXPECT_EQ(ill.exit_code, 1);
}

TEST_F(RealNetworkFaults, MulticastIsHeardOnAGoodCard) {
    const Outcome well = shell(doctor("--for world --interface veth0"));
    EXPECT_TRUE(finding(well, "multicast_not_heard").is_null());
    EXPECT_THAT(well.output, HasSubstr("\"value\": \"heard\""));
}

TEST_F(RealNetworkFaults, FirewallDropsDds) {
    // some kernels have no nf_tables
    const Outcome usable = run_program("nft add table inet lab", kLimit_s);
    if (usable.exit_code != 0)
        GTEST_SKIP() << atrium::test::skip::kNoNetwork << "nft: " << usable.output;
    const std::string drop =
        "nft flush ruleset\nnft add table inet lab\n"
        "nft 'add chain inet lab in { type filter hook input priority 0; policy accept; }'\n"
        "nft add rule inet lab in ct state established accept\n"
        "nft add rule inet lab in udp dport 7400-7420 counter drop\n";
    const Outcome ill = shell(drop + doctor("--for world --interface veth0"));
    EXPECT_TRUE(finding(ill, "multicast_not_heard").is_null()) << "one cause is enough";
    expect_cured(drop, "firewall_drops_dds", "--for world --interface veth0");
    const Outcome well =
        shell(drop + finding(ill, "firewall_drops_dds")["cure"].get<std::string>() + "\n" +
              doctor("--for world --interface veth0"));
    EXPECT_TRUE(finding(well, "multicast_not_heard").is_null()) << well.output;
    // a rule that is not understood shows itself by what it does
    const Outcome odd = shell(
        "nft flush chain inet lab in\nnft add rule inet lab in meta mark 0 udp dport 7400 "
        "drop\n" +
        doctor("--for world --interface veth0"));
    EXPECT_FALSE(finding(odd, "multicast_not_heard").is_null()) << odd.output;
    run_program("nft flush ruleset", kLimit_s);
}

TEST_F(RealNetworkFaults, SmallMtuOfACamera) {
    test_support::FakeGigeCamera::Options options;
    options.address = "127.0.0.1";
    options.serial = "D0C70R";
    const test_support::FakeGigeCamera camera(options);
    ASSERT_TRUE(camera.is_running());
    fs::create_symlink(ATRIUM_BIN_DIR "/site_node", folder_ / "bin" / "site_node");
    expect_cured("ip link set lo mtu 1500", "mtu_small", "--for camera --interface lo");
}

TEST_F(RealNetworkFaults, NoCamera) {
    fs::create_symlink(ATRIUM_BIN_DIR "/site_node", folder_ / "bin" / "site_node");
    const Outcome ill = shell(doctor("--for camera"));
    EXPECT_FALSE(finding(ill, "no_camera").is_null()) << ill.output;
    EXPECT_EQ(ill.exit_code, 1);
}

// The name that the system has and the one that the finding's command gives.
TEST_F(RealNetworkFaults, HostNotInFile) {
    const std::string hall = atrium::test::source_dir() + "/deploy/sites/hall.toml";
    const auto named = [&](const std::string& name, const std::string& command) {
        return shell("unshare -u sh -c 'echo " + name + " > /proc/sys/kernel/hostname && " +
                     command + "'");
    };
    const Outcome ill = named("north.lab", doctor(hall));
    const json found = finding(ill, "host_not_in_file");
    ASSERT_FALSE(found.is_null()) << ill.output;
    EXPECT_EQ(ill.exit_code, 1);
    std::string cure = found["cure"];
    const std::string command = "atrium doctor";
    ASSERT_EQ(cure.find(command), 0u) << cure;
    cure.replace(0, command.size(), doctor(""));
    for (const Outcome& well : {named("north.lab", cure), named("north", doctor(hall))}) {
        EXPECT_TRUE(finding(well, "host_not_in_file").is_null()) << well.output;
        const json missing = finding(well, "program_missing");  // there is none in the folder
        ASSERT_FALSE(missing.is_null()) << well.output;
        EXPECT_THAT(missing["text"].get<std::string>(), HasSubstr("camera_node"));
    }
}

TEST_F(RealNetworkFaults, NoCameraOnAHostWithCameraNodeOnly) {
    fs::create_symlink(ATRIUM_BIN_DIR "/camera_node", folder_ / "bin" / "camera_node");
    const Outcome ill = shell(doctor("--for camera"));
    const json found = finding(ill, "no_camera");
    ASSERT_FALSE(found.is_null()) << ill.output;
    EXPECT_THAT(found["cure"].get<std::string>(), HasSubstr("camera_node --list-cameras"));
    EXPECT_EQ(ill.exit_code, 1);
}

// Mounts need a namespace, in which this test is.
class RealDiskFaults : public RealNetworkFaults {
protected:
    std::string mount(const std::string& options) const {
        const std::string folder = (folder_ / "disk").string();
        return "mkdir -p " + folder + "\nmount -t tmpfs -o " + options + " tmpfs " + folder + "\n";
    }
    std::string recordings() const {
        return "--for world --recordings " + (folder_ / "disk").string();
    }
};

TEST_F(RealDiskFaults, DiskFull) {
    const Outcome ill = shell(mount("size=4m") + doctor(recordings()));
    const json found = finding(ill, "disk_full");
    ASSERT_FALSE(found.is_null()) << ill.output;
    EXPECT_THAT(found["text"].get<std::string>(), HasSubstr("4 MiB left"));
    EXPECT_EQ(shell(mount("size=4m") + found["cure"].get<std::string>()).exit_code, 0);
}

TEST_F(RealDiskFaults, FolderOfReadOnlyDisk) {
    const Outcome ill = shell(mount("ro,size=4m") + doctor(recordings()));
    const json found = finding(ill, "folder_not_writable");
    ASSERT_FALSE(found.is_null()) << ill.output;
    EXPECT_THAT(found["text"].get<std::string>(), HasSubstr("Read-only file system"));
    expect_cured(mount("ro,size=4m"), "folder_not_writable", recordings());
}

TEST_F(RealFaults, CertificateExpired) {
    if (run_program("openssl version", kLimit_s).exit_code != 0) {
        std::ofstream(folder_ / "lab.pem") << "-----BEGIN CERTIFICATE-----\n";
        const Outcome ill = run_program(doctor("--for world --keys " + folder_.string()), kLimit_s);
        EXPECT_FALSE(finding(ill, "openssl_missing").is_null()) << ill.output;
        return;
    }
    const std::string made =
        "cd " + folder_.string() +
        " && openssl req -newkey rsa:2048 -nodes -keyout key.pem -out a.csr -subj /CN=lab "
        "2>/dev/null && openssl x509 -req -in a.csr -signkey key.pem -days -1 -out lab.pem "
        "2>/dev/null && chmod 600 key.pem";
    ASSERT_EQ(run_program("sh -c '" + made + "'", kLimit_s).exit_code, 0);
    const std::string arguments = "--for world --keys " + folder_.string();
    const Outcome ill = run_program(doctor(arguments), kLimit_s);
    const json found = finding(ill, "key_expired");
    ASSERT_FALSE(found.is_null()) << ill.output;
    EXPECT_TRUE(finding(ill, "private_key_readable").is_null()) << ill.output;
    std::string cure = found["cure"];
    cure.replace(cure.find("KEY"), 3, (folder_ / "key.pem").string());
    EXPECT_EQ(run_program(cure, kLimit_s).exit_code, 0) << cure;
    EXPECT_TRUE(fs::exists(folder_ / "lab.pem.csr"));
}

TEST_F(RealFaults, PrivateKeyReadable) {
    const fs::path key = folder_ / "it's a key.pem";
    std::ofstream(key) << "-----BEGIN PRIVATE KEY-----\n";
    fs::permissions(key, static_cast<fs::perms>(0644));
    const std::string arguments = "--for world --keys " + folder_.string();
    const json found = finding(run_program(doctor(arguments), kLimit_s), "private_key_readable");
    ASSERT_FALSE(found.is_null());
    std::string cure = found["cure"];
    if (cure.rfind("sudo ", 0) == 0) cure.erase(0, 5);
    EXPECT_EQ(run_program(cure, kLimit_s).exit_code, 0) << cure;
    EXPECT_EQ(fs::status(key).permissions(), static_cast<fs::perms>(0640));
}

TEST_F(RealFaults, LibraryMissing) {
    const std::string made =
        "cd " + folder_.string() +
        " && echo 'int f(void) { return 0; }' > f.c && " ATRIUM_CC
        " -shared -fPIC -Wl,-soname,libatrium_lab.so.1 -o libatrium_lab.so.1 f.c && echo "
        "'int f(void); int main(void) { return f(); }' > m.c && " ATRIUM_CC
        " -o bin/viewer m.c ./libatrium_lab.so.1 && rm libatrium_lab.so.1";
    std::ofstream(folder_ / "make.sh") << made << "\n";
    const Outcome compiled = run_program("sh " + (folder_ / "make.sh").string(), kLimit_s);
    ASSERT_EQ(compiled.exit_code, 0) << compiled.output;
    const Outcome ill = run_program(doctor("--for viewer"), kLimit_s);
    const json found = finding(ill, "library_missing");
    ASSERT_FALSE(found.is_null()) << ill.output;
    EXPECT_THAT(found["text"].get<std::string>(), HasSubstr("missing libatrium_lab.so.1"));
    EXPECT_THAT(found["cure"].get<std::string>(), HasSubstr("apt-file search libatrium_lab.so.1"));
}

TEST_F(RealFaults, VersionsMixed) {
    add_program("viewer", "echo viewer 0.1.0");
    add_program("world_server", "echo world_server 0.2.0");
    const Outcome ill = run_program(doctor("--for world"), kLimit_s);
    const json found = finding(ill, "versions_mixed");
    ASSERT_FALSE(found.is_null()) << ill.output;
    EXPECT_THAT(found["text"].get<std::string>(), HasSubstr("0.1.0 (viewer) and 0.2.0"));
}

TEST_F(RealFaults, ProgramRunsTwice) {
    fs::copy_file("/bin/sleep", folder_ / "site_node");
    const std::string twice = (folder_ / "site_node").string() + " 100 & a=$!\n" +
                              (folder_ / "site_node").string() + " 100 & b=$!\n";
    const std::string script = (folder_ / "twice.sh").string();
    // a child of a shell is a shell until it has started its program
    std::ofstream(script)
        << twice << "for p in $a $b; do\n"
        << "  until [ \"$(cat /proc/$p/comm)\" = site_node ] || ! kill -0 $p; do :; done\n"
        << "done\n"
        << doctor("--for world") << "\nkill $a $b\n";
    const Outcome ill = run_program("sh " + script, kLimit_s);
    const json found =
        finding({0, ill.output.substr(0, ill.output.rfind('}') + 1)}, "program_runs_twice");
    ASSERT_FALSE(found.is_null()) << ill.output;
    EXPECT_THAT(found["cure"].get<std::string>(), HasSubstr("kill "));
}

TEST_F(RealFaults, HealthyCopyOfAHostIsSilent) {
    const FakeHost host(folder_ / "host");
    const Outcome well = run_program(kDoctor + " --root " + host.at("/").string(), kLimit_s);
    EXPECT_EQ(well.exit_code, 0);
    EXPECT_EQ(well.output, "");
}

TEST_F(RealFaults, CopyOfAHostShowsItsFault) {
    const FakeHost host(folder_ / "host");
    host.write("/proc/sys/net/core/rmem_max", "212992");
    const Outcome ill = run_program(kDoctor + " --root " + host.at("/").string(), kLimit_s);
    EXPECT_EQ(ill.exit_code, 1);
    EXPECT_THAT(ill.output, HasSubstr("costs  net.core.rmem_max is 208 KiB"));
    EXPECT_EQ(ill.output.find('\x1b'), std::string::npos);
}

TEST_F(RealFaults, WrongCommandLinesAreNamed) {
    for (const std::string arguments : {"--for nobody",
                                        "--network lam",
                                        "--root /nonexistent",
                                        "--no-such-option",
                                        "--host north"})
        EXPECT_EQ(run_program(kDoctor + " " + arguments, kLimit_s).exit_code, 2) << arguments;
    EXPECT_EQ(run_program(kDoctor + " /nonexistent.toml", kLimit_s).exit_code, 3);
}

}  // namespace
}  // namespace atrium::doctor

int main(int argc, char** argv) {
    atrium::test_support::enter_own_network(2);
    testing::InitGoogleMock(&argc, argv);
    return RUN_ALL_TESTS();
}
