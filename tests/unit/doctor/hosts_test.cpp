#include "tests/unit/doctor/fake_host.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <unistd.h>

#include <algorithm>

// What is no fault on one host of a site on several hosts.
namespace atrium::doctor {
namespace {

using testing::HasSubstr;

std::filesystem::path hosts_folder(const std::string& name) {
    return std::filesystem::path(testing::TempDir()) /
           ("atrium_doctor_" + std::to_string(getpid())) / name;
}

std::string report_on(const FakeHost& host, const std::string& name, double rate_hz = 30.0) {
    const auto report = examine({.file = host.write_hosts(rate_hz),
                                 .host = name,
                                 .recordings = host.folder(),
                                 .programs = host.programs()},
                                host,
                                {});
    return report ? report->text : report.error().message;
}

TEST(DoctorHosts, AreSilentIfHealthy) {
    const FakeHost host(hosts_folder("healthy_hosts"));
    for (const std::string name : {"", "left", "right", "hull", "stairs"})
        EXPECT_EQ(report_on(host, name), "") << name;
}

// Hosts that are simulated on one.
TEST(DoctorHosts, MayRunBesideEachOther) {
    const auto report = [](const std::string& first, const std::string& second) {
        FakeHost host(hosts_folder("beside"));
        const auto run = [&](int id, const std::string& name) {
            std::string command = "camera_node --config hall.toml " + name;
            std::ranges::replace(command, ' ', '\0');
            host.add_process(id, "camera_node", command);
        };
        run(801, first);
        run(802, second);
        return report_on(host, "left");
    };
    EXPECT_EQ(report("--host left", "--host right"), "");
    EXPECT_EQ(report("--host=left", "--site.host right"), "");
    EXPECT_THAT(
        report("--host left", "--host=left"),
        HasSubstr("camera_node --host left runs 2 times on this host (processes 801, 802)"));
}

// The programs know the rules of their files.
TEST(DoctorHosts, SayWhatTheProgramsRefuse) {
    FakeHost host(hosts_folder("refused"));
    const std::string file = host.write_hosts(30.0).string();
    const auto refuse = [&](const std::string& program, const std::string& name, int exit_code) {
        host.outputs[program + " --config " + file + " --host " + name +
                     " --log-level error --check"] = {
            exit_code,
            "2026-11-28 error camera_node x\n" + program + ": error: " + file +
                ":7: unknown key 'camera' of " + name + "\n"};
    };
    refuse("camera_node", "left", 2);
    refuse("site_node", "hull", 2);
    refuse("site_node", "stairs", 3);  // a missing file is a finding of its own
    EXPECT_EQ(report_on(host, "left"), file + ":7: unknown key 'camera' of left");
    EXPECT_EQ(report_on(host, "hull"), file + ":7: unknown key 'camera' of hull");
    EXPECT_EQ(report_on(host, "stairs"), "");
    EXPECT_EQ(report_on(host, "right"), "");
    EXPECT_EQ(report_on(host, "attic"), file + ":7: unknown key 'camera' of left")
        << "the part of the first host";
}

TEST(DoctorHosts, TakeTheirNameFromTheSystem) {
    FakeHost host(hosts_folder("own_name"));
    host.write("/proc/sys/kernel/hostname", "right\n");
    host.set_cameras({{"192.168.1.12", "102"}});
    EXPECT_EQ(report_on(host, ""), "");
    EXPECT_THAT(report_on(host, "left"), HasSubstr("[camera_missing]"));
}

TEST(DoctorHosts, NeedNoCamerasOfOthers) {
    FakeHost host(hosts_folder("others_cameras"));
    host.set_cameras({{"192.168.1.11", "101"}});
    EXPECT_EQ(report_on(host, "left"), "");
    host.set_cameras({{"192.168.1.12", "102"}});
    EXPECT_EQ(report_on(host, "right"), "");
}

TEST(DoctorHosts, NeedNoCamerasWithoutAny) {
    FakeHost host(hosts_folder("no_cameras"));
    for (const char* program : {"site_node", "camera_node"})
        host.outputs[std::string(program) + " --list-cameras"] = {3, "no camera answers\n"};
    EXPECT_EQ(report_on(host, "hull"), "");
    EXPECT_EQ(report_on(host, "stairs"), "");
    EXPECT_THAT(report_on(host, "left"), HasSubstr("[no_camera]"));
}

TEST(DoctorHosts, CarryOnlyTheirOwnPictures) {
    FakeHost host(hosts_folder("own_pictures"));
    constexpr double kRate_hz = 100.0;  // 800 Mbit/s of each camera, 100 MB/s
    host.disk_mb_per_s = 110.0;
    host.write("/sys/devices/system/cpu/online", "0\n");
    host.in_one_second = [](const FakeHost&) {};
    EXPECT_EQ(report_on(host, "left", kRate_hz), "");
    const auto alone =
        host.examine_json({.file = host.write_site(kRate_hz), .recordings = host.folder()});
    for (const char* id : {"cameras_exceed_link", "disk_slow"})
        EXPECT_THAT(alone->text, HasSubstr(id));
}

TEST(DoctorHosts, NeedOnlyTheProgramsOfTheirPart) {
    const FakeHost host(hosts_folder("own_programs"));
    std::filesystem::remove(host.programs() / "site_node");
    EXPECT_EQ(report_on(host, "left"), "");
    const FakeHost other(hosts_folder("own_programs_2"));
    std::filesystem::remove(other.programs() / "camera_node");
    EXPECT_EQ(report_on(other, "hull"), "");
    EXPECT_EQ(report_on(other, "stairs"), "");
}

TEST(DoctorHosts, NeedRightsOnlyOfTheirProgram) {
    FakeHost host(hosts_folder("own_rights"));
    host.capabilities_of["site_node"] = 0;
    EXPECT_EQ(report_on(host, "left"), "");
    host.capabilities_of = {{"camera_node", 0}};
    EXPECT_FALSE(host.examine_json({.file = host.write_site()})->is_ill);
    EXPECT_FALSE(host.examine_json()->is_ill) << "one of both may be used";
}

TEST(DoctorHosts, MayLackTheCacheWithoutTheModelPart) {
    FakeHost host(hosts_folder("own_cache"));
    host.disk_mb_per_s = make_error(ErrorKind::kUnavailable, "Permission denied");
    const auto file = host.write_hosts();
    FakeHost::name_cache(file, "/srv/kept");
    for (const std::string name : {"left", "stairs"})
        EXPECT_FALSE(host.examine_json({.file = file, .host = name})->is_ill) << name;
}

TEST(DoctorHosts, ThatRunTheWorldOnlyNeedNoEntry) {
    const FakeHost host(hosts_folder("world_host"));
    const auto report = host.examine_json(
        {.file = host.write_hosts(), .roles = Roles{.world = true}, .host = "world"});
    ASSERT_TRUE(report) << report.error().message;
    EXPECT_FALSE(report->is_ill) << report->text;
}

TEST(DoctorHosts, WantThePreciseClockOnlyInASite) {
    FakeHost host(hosts_folder("clock"));
    host.outputs["chronyc -n -c tracking"] = {0, tracking(0.0, 0.08, 0.009)};
    EXPECT_FALSE(host.examine_json()->is_ill);
    EXPECT_FALSE(host.examine_json({.file = host.write_site()})->is_ill);
    EXPECT_TRUE(host.examine_json({.file = host.write_hosts()})->is_ill);
}

// The server in the LAN has its time from the Internet.
TEST(DoctorHosts, OnlyHaveToAgree) {
    FakeHost host(hosts_folder("agree"));
    host.outputs["chronyc -n -c tracking"] = {0, tracking(1e-5, 0.04, 0.009, 1e-5, "10.0.0.7")};
    EXPECT_FALSE(host.examine_json({.file = host.write_hosts()})->is_ill);
}

TEST(DoctorHosts, MayBeTheTimeServerOfTheOthers) {
    FakeHost host(hosts_folder("time_server"));
    host.outputs["chronyc -n -c tracking"] = {0, tracking(1e-5, 0.04, 0.009)};
    EXPECT_TRUE(host.examine_json({.file = host.write_hosts()})->is_ill);
    for (const char* file : {"/etc/chrony/chrony.conf", "/etc/chrony/conf.d/lab.conf"}) {
        host.write(file, "pool 2.debian.pool.ntp.org iburst\n# allow\n allow 10.0.0.0/24\n");
        EXPECT_FALSE(host.examine_json({.file = host.write_hosts()})->is_ill) << file;
        host.remove(file);
    }
}

// The kernel's figure grows until the daemon asks its time server again.
TEST(Clock, IsNotWrongBetweenTheAnswersOfItsServer) {
    FakeHost host(hosts_folder("answers"));
    host.remove("/proc/700");
    host.add_process(710, "systemd-timesyn");
    host.kernel_clock.max_error_ms = 0.5 * 2048;
    EXPECT_FALSE(host.examine_json()->is_ill);
}

TEST(Clock, SurvivesHostileChrony) {
    FakeHost host(hosts_folder("hostile_chrony"));
    const std::string commas = "a,10.0.0.7,3,4";
    for (const std::string& text : {std::string(),
                                    std::string("\n"),
                                    std::string(13, ','),
                                    commas + ",nan,5,nan,7,8,9,nan,nan,12,Normal",
                                    commas + ",1e999,5,inf,7,8,9,-inf,1e308,12,Normal",
                                    commas + ",1e308,5,1e308,7,8,9,1e308,1e308,12,Normal",
                                    commas + ",0.1x,5,6,7,8,9,10,11,12,Normal",
                                    commas + ",99,5,6,7,8,9,10,11,12",
                                    commas + ",99,5,6,7,8,9,10,11,12,Normal\nand more\n"}) {
        host.outputs["chronyc -n -c tracking"] = {0, text};
        const auto report = host.examine_json({.file = host.write_hosts()});
        ASSERT_TRUE(report) << text;
        EXPECT_FALSE(report->is_ill) << text << report->text;
    }
    host.outputs["chronyc -n -c tracking"] = {1, tracking(9.0, 9.0, 9.0)};
    EXPECT_FALSE(host.examine_json()->is_ill) << "506 Cannot talk to daemon";
}

TEST(DoctorHosts, MayBeSimulated) {
    const FakeHost host(hosts_folder("simulated"));
    host.write_site();  // for its rig
    const auto file = host.write_beside("room.toml",
                                        "[capture]\nrig = \"rig.toml\"\n[bus]\nnetwork = \"lan\"\n"
                                        "[[host]]\nname = \"left\"\ncameras = [\"cam1\"]\n"
                                        "[[host]]\nname = \"hull\"\nmodel = true\n"
                                        "cameras = [\"cam2\"]\n");
    for (const std::string name : {"left", "hull"}) {
        const auto wishes = read_wishes(file, name);
        ASSERT_TRUE(wishes) << wishes.error().message;
        ASSERT_EQ(wishes->cameras.size(), 1u) << name;
        EXPECT_EQ(wishes->cameras[0].name, name == "left" ? "cam1" : "cam2");
        EXPECT_EQ(wishes->cameras[0].megapixels, 1.0);
    }
    EXPECT_TRUE(read_wishes(file, "")->cameras.empty());
}

TEST(DoctorHosts, AreShownAmongWhatWasChecked) {
    const FakeHost host(hosts_folder("shown"));
    const auto shown = [&](const std::string& name) {
        return examine({.file = host.write_hosts(), .host = name}, host, {.shows_checked = true})
            ->text;
    };
    EXPECT_THAT(shown("left"), HasSubstr("left: cameras"));
    EXPECT_THAT(shown("hull"), HasSubstr("hull: hull"));
    EXPECT_THAT(shown("stairs"), HasSubstr("stairs: regions"));
    EXPECT_THAT(shown("pc7"), HasSubstr("pc7, not in the file"));
}

TEST(DoctorHosts, WithAWrongTableAreAnError) {
    const FakeHost host(hosts_folder("wrong_hosts"));
    const auto wrong =
        host.examine_json({.file = host.write_beside("w.toml",
                                                     "[capture]\n[[host]]\nname = \"left\"\n"
                                                     "cameras = \"all\"\n")});
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().kind, ErrorKind::kConfiguration);
    EXPECT_THAT(wrong.error().message, HasSubstr("w.toml:4"));
}

TEST(HostName, IsWrittenAsThePrograms) {
    const FakeHost host(hosts_folder("name"));
    for (const auto& [system, name] :
         {std::pair<std::string, std::string>{"lab-1.example\n", "lab-1.example"},
          {"lab one\n", "lab-one"},
          {std::string(100, 'a') + "\n", std::string(63, 'a')},
          {"", ""}}) {
        host.write("/proc/sys/kernel/hostname", system);
        EXPECT_EQ(host_name(host), name);
    }
}

}  // namespace
}  // namespace atrium::doctor
