#include "tests/unit/doctor/faults.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <fstream>
#include <set>

namespace atrium::doctor {
namespace {

using nlohmann::json;
using testing::HasSubstr;

std::filesystem::path faults_folder(const std::string& name) {
    return std::filesystem::path(testing::TempDir()) /
           ("atrium_doctor_" + std::to_string(getpid())) / name;
}

class Doctor : public testing::TestWithParam<Fault> {};

TEST_P(Doctor, FindsOneFaultAndItsCure) {
    const Fault& fault = GetParam();
    FakeHost host(faults_folder(fault.name));
    Options options;
    fault.provoke(host, options);
    const auto report = host.examine_json(options);
    ASSERT_TRUE(report) << report.error().message;
    const json found = json::parse(report->text);
    ASSERT_EQ(found["findings"].size(), 1u) << report->text;
    const json& finding = found["findings"][0];
    EXPECT_EQ(finding["id"], fault.id);
    EXPECT_THAT(finding["text"].get<std::string>(), HasSubstr(fault.text));
    EXPECT_THAT(finding["cure"].get<std::string>(), HasSubstr(fault.cure));
    EXPECT_EQ(finding["keep"].is_null(), fault.keep.empty()) << finding["keep"];
    EXPECT_THAT(finding["keep"].is_null() ? "" : finding["keep"].get<std::string>(),
                HasSubstr(fault.keep));
    EXPECT_EQ(report->is_ill, finding["severity"] != "note");
    EXPECT_EQ(found["healthy"], !report->is_ill);
}

INSTANTIATE_TEST_SUITE_P(Faults, Doctor, testing::ValuesIn(all_faults()), [](const auto& fault) {
    return fault.param.name;
});

TEST(DoctorFaults, ProvokeEveryFinding) {
    std::set<std::string> provoked;
    for (const Fault& fault : all_faults()) provoked.insert(fault.id);
    std::set<std::string> known;
    for (const KnownFinding& finding : known_findings()) known.insert(finding.id);
    EXPECT_EQ(provoked, known);
}

TEST(DoctorFaults, AreNamedOnce) {
    std::set<std::string> names;
    for (const Fault& fault : all_faults())
        EXPECT_TRUE(names.insert(fault.name).second) << fault.name;
}

TEST(DoctorHealthy, IsSilent) {
    const FakeHost host(faults_folder("healthy"));
    const auto report = examine({.programs = host.programs()}, host, {});
    ASSERT_TRUE(report);
    EXPECT_EQ(report->text, "");
    EXPECT_FALSE(report->is_ill);
}

TEST(DoctorHealthy, IsSilentWithASiteFileKeysAndRecordings) {
    const FakeHost host(faults_folder("healthy_site"));
    host.write_beside("keys/ca.pem", "no certificate\n");
    // as docs/packages.md
    const auto key = host.write_beside("keys/key.pem", "-----BEGIN PRIVATE KEY-----\n");
    std::filesystem::permissions(key, std::filesystem::perms{0640});
    const auto report = examine({.file = host.write_site(),
                                 .recordings = host.folder(),
                                 .keys = host.folder() / "keys",
                                 .programs = host.programs()},
                                host,
                                {});
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_EQ(report->text, "");
}

// Debian opens the GPU so to the user at the screen, who is in no group of it.
TEST(DoctorHealthy, MayHaveDevicesByAListOfAccess) {
    FakeHost host(faults_folder("listed"));
    host.listed = {"/dev/dri/renderD128", "/dev/bus/usb/002/003"};
    for (const std::string& node : host.listed) host.write(node, "", 0660);
    EXPECT_FALSE(host.examine_json()->is_ill);
    host.listed.clear();
    const auto closed = host.examine_json();
    EXPECT_THAT(closed->text, HasSubstr("gpu_not_permitted"));
    EXPECT_THAT(closed->text, HasSubstr("usb_camera_not_permitted"));
}

// The default folder is below the one in which the site is started, which is not known.
TEST(DoctorHealthy, NeedsNoCacheThatTheFileDoesNotName) {
    FakeHost host(faults_folder("cache"));
    host.disk_mb_per_s = make_error(ErrorKind::kUnavailable, "Permission denied");
    EXPECT_FALSE(host.examine_json({.file = host.write_site()})->is_ill);
}

// The services have the rights that a user lacks, and their own folder.
TEST(DoctorHealthy, LeavesRightsToTheServices) {
    FakeHost host(faults_folder("services"));
    const std::filesystem::path site = host.install();
    const std::filesystem::path world = host.at("/etc/atrium/world.toml");
    host.write("/etc/atrium/world.toml", "[process]\nnice = -5\n");
    FakeHost::name_cache(site, "/srv/kept");
    std::ofstream(site, std::ios::app) << "[process]\nnice = -5\n";
    host.capabilities = 0;
    host.write("/proc/self/limits",
               "Max nice priority         0      0\nMax realtime priority     0      0\n");
    host.write("/dev/bus/usb/002/003", "", 0664);
    host.disk_mb_per_s = make_error(ErrorKind::kUnavailable, "Permission denied");
    for (const auto& file : {site, world}) {
        const auto well = host.examine_json({.file = file});
        ASSERT_TRUE(well) << well.error().message;
        EXPECT_FALSE(well->is_ill) << well->text;
        EXPECT_THAT(well->text, HasSubstr("those of the service that runs the file"));
    }
    for (const char* unit : {"atrium-site@.service", "atrium-world.service"})
        host.remove(std::string("/lib/systemd/system/") + unit);
    const auto own = host.examine_json({.file = site});
    for (const char* id : {"no_packet_socket",
                           "no_realtime",
                           "nice_not_permitted",
                           "usb_camera_not_permitted",
                           "cache_not_writable"})
        EXPECT_THAT(own->text, HasSubstr(id));
    EXPECT_THAT(host.examine_json({.file = world})->text, HasSubstr("nice_not_permitted"));
}

TEST(DoctorHealthy, SaysSoOnATerminal) {
    const FakeHost host(faults_folder("healthy_terminal"));
    const auto report = examine({.programs = host.programs()}, host, {.says_healthy = true});
    ASSERT_TRUE(report);
    EXPECT_EQ(std::count(report->text.begin(), report->text.end(), '\n'), 1);
}

TEST(DoctorHealthy, ListsWhatWasChecked) {
    const FakeHost host(faults_folder("healthy_verbose"));
    const auto report = examine({.programs = host.programs()}, host, {.shows_checked = true});
    ASSERT_TRUE(report);
    EXPECT_THAT(report->text,
                testing::AllOf(HasSubstr("eth0 (10.0.0.2)"),
                               HasSubstr("Mako G-319"),
                               HasSubstr("synchronised"),
                               HasSubstr("16 MiB")));
}

TEST(DoctorHealthy, SaysThatKeysNeedRoot) {
    Facts facts;
    facts.keys.emplace();
    facts.keys->folder = kKeys;
    facts.keys->is_there = true;
    facts.keys->is_readable = false;
    EXPECT_EQ(describe(facts).back().value, "unknown: /etc/atrium/keys needs root");
}

TEST(DoctorHealthy, SaysWhoseBundleItIs) {
    Facts facts;
    facts.keys.emplace();
    facts.keys->folder = "alice.bundle";
    facts.keys->is_there = true;
    facts.keys->certificates = {{"alice.bundle", {}, {}, "site alice of world playroom"}};
    EXPECT_EQ(describe(facts).back().value,
              "1 certificate in alice.bundle: site alice of world playroom");
    facts.keys->certificates.assign(10, facts.keys->certificates.front());
    EXPECT_THAT(describe(facts).back().value, HasSubstr(", 2 more"));
}

TEST(DoctorText, WrapsSentencesButNoCommand) {
    FakeHost host(faults_folder("text"));
    host.write("/proc/sys/net/core/rmem_max", "212992");
    host.write("/sys/class/net/eth0/flags", "0x3");
    const auto report = examine({.programs = host.programs()}, host, {.width = 60});
    ASSERT_TRUE(report);
    const std::vector<std::string> lines = lines_of(report->text);
    EXPECT_THAT(lines[0], testing::StartsWith("stops  The network card eth0"));
    std::size_t num_commands = 0;
    for (const std::string& line : lines) {
        const bool is_command = line.find("sudo ") != std::string::npos;
        num_commands += is_command ? 1 : 0;
        if (!is_command) {
            EXPECT_LE(line.size(), 60u) << line;
        }
    }
    EXPECT_EQ(num_commands, 4u) << report->text;  // now and after a restart
    EXPECT_EQ(lines[lines.size() - 2], "1 stops Atrium, 1 costs pictures.");
}

TEST(DoctorText, HasColoursOnlyIfTheStyleAllows) {
    FakeHost host(faults_folder("colours"));
    host.write("/proc/sys/net/core/rmem_max", "212992");
    const auto plain = examine({.programs = host.programs()}, host, {});
    const auto coloured = examine({.programs = host.programs()}, host, {.has_colour = true});
    EXPECT_EQ(plain->text.find('\x1b'), std::string::npos);
    EXPECT_NE(coloured->text.find('\x1b'), std::string::npos);
}

TEST(DoctorText, LeavesSudoOutForRoot) {
    FakeHost host(faults_folder("root"));
    host.who.is_root = true;
    host.write("/etc/atrium/keys/my sudo key.pem", "-----BEGIN PRIVATE KEY-----\n", 0644);
    host.write("/proc/sys/net/core/rmem_max", "212992");
    const auto report = examine({.programs = host.programs()}, host, {});
    EXPECT_THAT(report->text, HasSubstr("  sysctl -w net.core.rmem_max"));
    EXPECT_THAT(report->text, HasSubstr("| tee /etc"));
    EXPECT_THAT(report->text, HasSubstr("  chmod o-rwx,g-w '/"));
    EXPECT_THAT(report->text, HasSubstr("my sudo key.pem'"));
}

TEST(DoctorText, ShowsLettersOfAllLanguages) {
    const auto shown = [](const std::string& name) {
        const Finding finding = make_finding("keys_missing", "x", "chmod " + name);
        return report_text(std::vector<Finding>{finding}, {}, {});
    };
    for (const std::string name : {"/home/jörg", "/home/Ελένη", "/home/山", "/home/😀"})
        EXPECT_THAT(shown(name), HasSubstr("chmod " + name));
    // controls, wrong UTF-8, and what turns the direction of text
    for (const std::string wrong : {"\x1b",
                                    "\x7f",
                                    "\xc2\x9b",
                                    "\xc1\xa1",
                                    "\xe0\x80\xa1",
                                    "\xed\xa0\x80",
                                    "\xf4\x90\x80\x80",
                                    "\xc3",
                                    "\xe2\x80\xae"}) {
        EXPECT_THAT(shown("a" + wrong + "b"), HasSubstr("chmod a?"));
        EXPECT_EQ(shown("a" + wrong + "b").find(wrong), std::string::npos);
    }
}

TEST(DoctorRoles, LimitTheChecks) {
    FakeHost host(faults_folder("roles"));
    host.remove("/dev/dri");
    const auto viewer = host.examine_json({.roles = Roles{.viewer = true}});
    EXPECT_TRUE(viewer->is_ill);
    const auto world = host.examine_json({.roles = Roles{.world = true}});
    EXPECT_FALSE(world->is_ill) << world->text;
}

TEST(DoctorRoles, LoopbackNeedsNoNetwork) {
    FakeHost host(faults_folder("loopback"));
    for (const char* card : {"eth0", "eth1"})
        host.write(std::string("/sys/class/net/") + card + "/flags", "0x1002");
    host.write("/proc/sys/net/ipv4/ipfrag_time", "30");
    host.kernel_clock.is_synchronised = false;
    host.addresses.resize(1);
    EXPECT_FALSE(host.examine_json({.network = "loopback"})->is_ill);
    EXPECT_TRUE(host.examine_json({.network = "lan"})->is_ill);
}

TEST(DoctorErrors, NameAMissingOrWrongFile) {
    const FakeHost host(faults_folder("errors"));
    const auto missing = host.examine_json({.file = "/nonexistent/site.toml"});
    ASSERT_FALSE(missing);
    EXPECT_EQ(missing.error().kind, ErrorKind::kNotFound);
    const auto wrong =
        host.examine_json({.file = host.write_beside("w.toml", "[capture]\nrate_hz = \"x\"\n")});
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(wrong.error().message, HasSubstr("w.toml:2"));
}

}  // namespace
}  // namespace atrium::doctor
