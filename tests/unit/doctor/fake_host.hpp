#pragma once

#include "tools/doctor/doctor.hpp"
#include "tools/doctor/facts/system.hpp"

#include <sys/types.h>

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

namespace atrium::doctor {

/// A host in a temporary folder: files as in /proc, /sys, /dev and /etc, and answers of what only a
/// running system knows. It is healthy until a test spoils it. Its user is not root.
///
/// eth0 leads to other hosts, eth1 has two GigE Vision cameras. Its name is "left".
class FakeHost : public System {
public:
    explicit FakeHost(const std::filesystem::path& folder);
    ~FakeHost() override;

    void write(const std::string& file, const std::string& content, mode_t mode = 0644) const;
    void remove(const std::string& file) const;
    /// A process with this name and counters of processor time.
    void add_process(int id, const std::string& name, const std::string& command = "") const;
    /// A file beside the tree, for configurations; returns its path.
    std::filesystem::path write_beside(const std::string& name, const std::string& content) const;
    /// A site file for two cameras of 1 MP at eth1, with its rig.
    std::filesystem::path write_site(double rate_hz = 30.0, const std::string& bus = "lan") const;
    /// Names a folder for kept silhouettes in a site file.
    static void name_cache(const std::filesystem::path& file, const std::string& folder);

    /// The same for a site on several hosts: left with cam1, right with those that no other has,
    /// hull with the model part, stairs with a region.
    std::filesystem::path write_hosts(double rate_hz = 30.0) const;
    /// Moves the programs to where Debian packages have them, with all that these set up, and
    /// returns the file of a site's service. The group of the services is that of this process.
    std::filesystem::path install();
    /// Adds a USB3 Vision camera that all may open, at this port of bus 2.
    void add_usb_camera(const std::string& port, int number) const;
    /// The cameras that answer, with addresses and serials.
    void set_cameras(const std::vector<std::pair<std::string, std::string>>& cameras);

    std::filesystem::path programs() const { return programs_; }
    std::filesystem::path folder() const { return folder_; }
    /// Examines this host as `atrium doctor --json` with its programs.
    Expected<Report> examine_json(Options options = {}) const;

    // answers
    std::map<std::string, Output> outputs;  // by command line, with program names without folders
    std::vector<CardAddress> addresses;
    System::Clock kernel_clock{true, 0.4};
    User who;
    std::set<std::string> listed;  // files that a list of access opens to this user
    std::uint64_t capabilities = ~std::uint64_t{0};  // of all programs but these
    std::map<std::string, std::uint64_t> capabilities_of;
    bool is_multicast_heard = true;
    Expected<double> disk_mb_per_s = 900.0;
    std::uint64_t disk_free = std::uint64_t{500} << 30U;
    std::map<std::string, std::string> variables;
    std::function<void(const FakeHost&)> in_one_second;  // what happens while counters are compared

    std::optional<Output> run(const std::vector<std::string>& command) const override;
    std::optional<std::vector<CardAddress>> card_addresses() const override { return addresses; }
    std::optional<System::Clock> clock() const override { return kernel_clock; }
    User user() const override { return who; }
    bool may_open(const std::string& file) const override {
        return listed.contains(file) || System::may_open(file);
    }
    std::optional<std::uint64_t> file_capabilities(
        const std::filesystem::path& file) const override;
    std::optional<bool> hears_multicast(std::uint32_t /*card_address*/) const override {
        return is_multicast_heard;
    }
    Expected<double> write_speed(const std::filesystem::path& /*folder*/,
                                 std::uint64_t /*bytes*/) const override {
        return disk_mb_per_s;
    }
    std::optional<std::uint64_t> free_bytes(
        const std::filesystem::path& /*folder*/) const override {
        return disk_free;
    }
    bool let_time_pass() const override;
    std::string variable(const std::string& name) const override;

private:
    std::filesystem::path folder_;
    std::filesystem::path programs_;
};

/// The processor's line of /proc/stat: ticks of user programs and of rest since the start.
std::string processor_ticks(int user, int idle);

/// What `chronyc -n -c tracking` prints; all in seconds.
std::string tracking(double offset_s,
                     double root_delay_s,
                     double root_dispersion_s,
                     double rms_offset_s = 1e-5,
                     const std::string& source = "203.0.113.5");

/// What `ethtool -g` prints of a receive ring.
std::string ring_of(int now, int largest);

/// The table of `site_node --list-cameras` with these addresses and serials.
std::string camera_table_of(const std::vector<std::pair<std::string, std::string>>& cameras);

}  // namespace atrium::doctor
