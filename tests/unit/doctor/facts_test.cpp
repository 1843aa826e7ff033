#include "core/bus/network_settings.hpp"
#include "network_needs.hpp"
#include "site_node/capture/camera_discovery.hpp"
#include "tests/support/source_dir.hpp"
#include "tests/unit/doctor/fake_host.hpp"
#include "tools/doctor/checks/checks.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/xattr.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <fstream>
#include <map>
#include <memory>
#include <random>

namespace atrium::doctor {
namespace {

namespace fs = std::filesystem;

fs::path facts_folder(const std::string& name) {
    return fs::path(testing::TempDir()) / ("atrium_doctor_" + std::to_string(getpid())) / name;
}

const std::vector<std::string>& hostile_texts() {
    static const std::vector<std::string> texts{
        "",
        "\n\n\n",
        "-1",
        "99999999999999999999999999999999",
        "18446744073709551615",
        "0x",
        "nan inf -0",
        std::string("a\0b\0", 4),
        "\xff\xfe\x80\n\x1b[2J",
        std::string(200'000, '7'),
        std::string(100'000, ' ') + "x",
        "a b c d e f g h i j k l m n\n: : : :\n(((((((\n))))))) 1 2 3\n",
        "cpu 18446744073709551615 18446744073709551615 1 1 1 1 1 1 1\n",
        "0-18446744073709551615,7-3,,,-\n",
        "MemTotal: 18446744073709551615 kB\nSwapTotal: 18446744073709551615 kB\n"};
    return texts;
}

// The report is always JSON with known findings, whose command lines are one line each.
void expect_sane(const FakeHost& host, const Options& options, const std::string& spoilt) {
    const auto report = host.examine_json(options);
    ASSERT_TRUE(report) << spoilt << ": " << report.error().message;
    const auto found = nlohmann::json::parse(report->text, nullptr, /*allow_exceptions=*/false);
    ASSERT_TRUE(found.is_object()) << spoilt;
    for (const auto& finding : found["findings"]) {
        const std::string cure = finding["cure"];
        EXPECT_FALSE(cure.empty()) << spoilt;
        EXPECT_EQ(cure.find('\n'), std::string::npos) << spoilt;
    }
}

std::vector<std::string> files_of(const FakeHost& host) {
    std::vector<std::string> files;
    for (const auto& entry : fs::recursive_directory_iterator(host.at("/"))) {
        if (entry.is_regular_file())
            files.push_back("/" + fs::relative(entry.path(), host.at("/")).string());
    }
    std::sort(files.begin(), files.end());
    return files;
}

TEST(DoctorProperty, SurvivesEveryHostileFile) {
    FakeHost host(facts_folder("hostile_files"));
    const Options options{.file = host.write_hosts(), .recordings = host.folder()};
    const std::vector<std::string> files = files_of(host);
    ASSERT_GT(files.size(), 50u);
    const std::vector<std::string>& texts = hostile_texts();
    for (std::size_t i = 0; i < files.size(); ++i) {
        const std::string healthy = host.read(files[i]).value_or("");
        // each file gets a third of the texts, other ones than its neighbours
        for (std::size_t j = i % 3; j < texts.size(); j += 3) {
            host.write(files[i], texts[j]);
            expect_sane(host, options, files[i]);
        }
        host.write(files[i], healthy);
    }
    for (const std::string& text : texts) {
        for (const std::string& file : files) host.write(file, text);
        expect_sane(host, options, "all files");
    }
}

TEST(DoctorProperty, SurvivesHostileAnswers) {
    FakeHost host(facts_folder("hostile_answers"));
    host.write("/etc/atrium/keys/a.pem", "-----BEGIN CERTIFICATE-----\n");
    const auto healthy = host.outputs;
    for (const auto& [command, output] : healthy) {
        for (const std::string& text : hostile_texts()) {
            for (const int exit_code : {0, 3, 127}) {
                host.outputs[command] = {exit_code, text};
                expect_sane(host, {}, command);
            }
        }
        host.outputs[command] = output;
    }
}

TEST(DoctorProperty, SurvivesRandomBytesInAllFiles) {
    std::mt19937 random(20261128);
    for (int round = 0; round < 15; ++round) {
        FakeHost host(facts_folder("random"));
        const Options options{.file = round % 2 == 0 ? host.write_site() : host.write_hosts()};
        for (const std::string& file : files_of(host)) {
            std::string text = host.read(file).value_or("");
            for (int i = 0; i < 4; ++i) {
                const auto at = text.empty() ? 0 : random() % text.size();
                text.insert(at, 1, static_cast<char>(random() % 256));
                if (random() % 3 == 0) text.resize(at);
            }
            host.write(file, text);
        }
        expect_sane(host, options, "round " + std::to_string(round));
    }
}

TEST(DoctorProperty, SurvivesAnEmptyTree) {
    FakeHost host(facts_folder("empty"));
    fs::remove_all(host.at("/"));
    expect_sane(host, {}, "all");
    const System nothing(host.folder() / "nowhere");
    EXPECT_TRUE(examine({}, nothing, {}));
}

TEST(DoctorProperty, ShowsNoControlCharacters) {
    FakeHost host(facts_folder("control"));
    host.write("/sys/class/net/\x1b[2J/flags", "0x1003");
    host.write("/proc/net/route", "x\n");
    const auto report = examine({.programs = host.programs()}, host, {.shows_checked = true});
    ASSERT_TRUE(report);
    EXPECT_EQ(report->text.find('\x1b'), std::string::npos);
}

// What a shell makes of a word.
std::string echoed(const std::string& word) {
    const std::string command = "printf %s " + word;
    const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), &pclose);
    std::string text;
    std::array<char, 256> part;
    while (std::fgets(part.data(), part.size(), pipe.get()) != nullptr) text += part.data();
    return text;
}

TEST(ShellWord, IsOneWordForAShell) {
    for (const std::string word : {"eth0",
                                   "eth0;reboot",
                                   "$(reboot)",
                                   "it's",
                                   "a b",
                                   "`x`",
                                   "",
                                   "\"",
                                   "\\",
                                   "*",
                                   "~",
                                   "-n#"})
        EXPECT_EQ(echoed(shell_word(word)), word);
    EXPECT_EQ(shell_word("eth0.5"), "eth0.5");
    EXPECT_EQ(shell_word("a\nb"), "'a?b'");
}

// As setfacl writes it: the owner, this user and the mask may read and write, nobody else.
bool list_user(const fs::path& file, std::uint32_t user) {
    struct Entry {
        std::uint16_t tag, permissions;
        std::uint32_t id;
    };
    constexpr std::uint32_t kNobody = 0xFFFFFFFF;
    const struct {
        std::uint32_t version = 2;
        std::array<Entry, 5> entries;
    } list{.entries = {{{0x01, 6, kNobody},
                        {0x02, 6, user},
                        {0x04, 0, kNobody},
                        {0x10, 6, kNobody},
                        {0x20, 0, kNobody}}}};
    return setxattr(file.c_str(), "system.posix_acl_access", &list, sizeof list, 0) == 0;
}

// Root opens all: it becomes another user while `look` runs.
constexpr uid_t kOther = 65'534;
template <typename Look>
void without_root(const Look& look) {
    const uid_t own = geteuid();
    if (own == 0) {
        ASSERT_EQ(seteuid(kOther), 0);
    }
    look();
    ASSERT_EQ(seteuid(own), 0);
}

TEST(LiveSystem, KnowsListsOfAccess) {
    const FakeHost host(facts_folder("lists"));
    host.write("/listed", "", 0600);
    host.write("/closed", "", 0000);
    const LiveSystem system(host.at("/"));
    const bool is_open = geteuid() != 0 || list_user(host.at("/listed"), kOther);
    without_root([&] {
        EXPECT_EQ(system.may_open("/listed"), is_open && system.exists("/listed"));
        EXPECT_FALSE(system.may_open("/closed"));
        EXPECT_TRUE(system.may_open("/missing"));
    });
}

TEST(Keys, AreThereThoughUnreadable) {
    const FakeHost host(facts_folder("unreadable_keys"));
    const fs::path folder = host.write_beside("keys/a.pem", "x").parent_path();
    EXPECT_TRUE(collect_keys(host, folder).is_readable);
    fs::permissions(folder, fs::perms::none);
    without_root([&] {
        const KeyFacts keys = collect_keys(host, folder);
        EXPECT_TRUE(keys.is_there);
        EXPECT_FALSE(keys.is_readable);
        EXPECT_TRUE(collect_keys(host, folder / "inside").is_there) << "nobody knows";
    });
    fs::permissions(folder, fs::perms::owner_all);
}

TEST(Keys, AreThoseOfOneFileWhateverItsName) {
    const FakeHost host(facts_folder("one_file"));
    const fs::path file = host.write_beside("keys/alice", "-----BEGIN CERTIFICATE-----\n");
    host.write_beside("keys/other.pem", "-----BEGIN CERTIFICATE-----\n");
    const KeyFacts keys = collect_keys(host, file);
    EXPECT_TRUE(keys.is_there);
    EXPECT_TRUE(keys.is_readable);
    ASSERT_EQ(keys.certificates.size(), 1u);
    EXPECT_EQ(keys.certificates.front().file, file);
    EXPECT_FALSE(collect_keys(host, file.parent_path() / "none").is_there);
    const KeyFacts damaged = collect_keys(host, host.write_beside("keys/damaged", "format = 1\n"));
    ASSERT_EQ(damaged.certificates.size(), 1u);
    EXPECT_NE(damaged.certificates.front().problem, "");
}

TEST(CameraTable, IsReadAsItIsPrinted) {
    const std::vector<capture::FoundCamera> printed{
        {"Allied Vision  GmbH", "Mako G-319", "23456701", "192.168.1.15", "GigEVision"},
        {"FLIR", "Blackfly S", "7", "FLIR-7", "USB3Vision"}};
    const auto read = parse_camera_table("some warning\n" + capture::camera_table(printed));
    ASSERT_EQ(read.size(), 2u);
    EXPECT_EQ(read[0].name, "Allied Vision  GmbH Mako G-319");
    EXPECT_EQ(read[0].serial, "23456701");
    EXPECT_EQ(read[0].address, "192.168.1.15");
    EXPECT_TRUE(read[0].is_gige);
    EXPECT_EQ(read[1].address, "FLIR-7");
    EXPECT_FALSE(read[1].is_gige);
}

TEST(Needs, AreThoseOfTheNetworkFiles) {
    for (const std::string network : {"loopback", "lan", "wifi", "wan"}) {
        bus::BusOptions options;
        options.network = network;
        options.interface = "lo";
        const auto settings = bus::load_network_settings(options);
        ASSERT_TRUE(settings) << settings.error().message;
        EXPECT_EQ(settings->receive_buffer_bytes, kReceiveBufferBytes) << network;
    }
}

TEST(Needs, AreMetByTheSettingsOfThePackages) {
    std::ifstream file(atrium::test::source_dir() + "/deploy/packages/90-atrium.conf");
    std::map<std::string, std::uint64_t> settings;
    for (std::string line; std::getline(file, line);) {
        const std::vector<std::string> words = words_of(line);
        if (words.size() == 3 && words[1] == "=")
            settings[words[0]] = parse_number(words[2]).value_or(0);
    }
    EXPECT_EQ(settings,
              (std::map<std::string, std::uint64_t>{
                  {"net.core.rmem_max", kReceiveBufferBytes},
                  {"net.core.wmem_max", kSendBufferBytes},
                  {"net.ipv4.ipfrag_time", kFragmentTime_s},
                  {"net.ipv4.ipfrag_high_thresh", kFragmentMemoryBytes}}));
}

TEST(Load, DoesNotCountAtriumItself) {
    FakeHost host(facts_folder("own_load"));
    host.add_process(900, "site_node");
    host.in_one_second = [](const FakeHost& later) {
        later.write("/proc/stat", processor_ticks(1400, 9400));
        later.write("/proc/900/stat", "900 (site_node) S 1 1 1 0 -1 0 0 0 0 0 850 20 0 0 20 0\n");
    };
    const Facts facts = collect(host, {.programs = host.programs()});
    ASSERT_TRUE(facts.load.busy_cores);
    EXPECT_NEAR(*facts.load.busy_cores, 0.5, 1e-9);  // 50 of 800 ticks, 8 cores
}

TEST(Files, OfTheDeliveryAreRead) {
    const FakeHost host(facts_folder("delivery"));
    const fs::path deploy = fs::path(atrium::test::source_dir()) / "deploy";
    int num_files = 0;
    for (const char* folder : {"sites", "worlds"}) {
        for (const auto& entry : fs::directory_iterator(deploy / folder)) {
            if (entry.path().extension() != ".toml") continue;
            ++num_files;
            const auto report = host.examine_json({.file = entry.path()});
            EXPECT_TRUE(report) << entry.path() << ": " << report.error().message;
        }
    }
    EXPECT_TRUE(host.examine_json({.file = deploy / "viewer.toml"}));
    EXPECT_GT(num_files, 8);
}

TEST(Roles, FollowTheFile) {
    const FakeHost host(facts_folder("roles"));
    const auto roles = [&](const std::string& text) {
        return names_of(*roles_of_file(host.write_beside("f.toml", text), "left"));
    };
    using Names = std::vector<std::string>;
    EXPECT_EQ(roles("[capture]\nsource = \"cameras\"\n"), (Names{"site", "camera"}));
    EXPECT_EQ(roles("[site]\nname = \"a\"\n"), Names{"site"});
    EXPECT_EQ(roles("[view]\nwidth = 640\n"), Names{"viewer"});
    EXPECT_EQ(roles("[[object]]\nname = \"b\"\n"), Names{"world"});
    const std::string hosts =
        "[capture]\nsource = \"cameras\"\n[[host]]\nname = \"hull\"\nmodel = true\n"
        "[[host]]\nname = \"left\"\n";
    EXPECT_EQ(roles(hosts + "cameras = [\"cam1\"]\n"), (Names{"site", "camera"}));
    EXPECT_EQ(roles(hosts + "cameras = \"auto\"\n"), (Names{"site", "camera"}));
    EXPECT_EQ(roles(hosts + "regions = [\"stairs\"]\n"), Names{"site"});
}

}  // namespace
}  // namespace atrium::doctor
