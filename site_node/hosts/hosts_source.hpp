#pragma once

#include "core/app/log.hpp"
#include "core/bus/bus.hpp"
#include "core/bus/messages.hpp"
#include "site_node/capture/frame_source.hpp"
#include "site_node/hosts/clock_epoch.hpp"
#include "site_node/hosts/host_table.hpp"

#include <cstdint>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

namespace atrium::hosts {

struct HostsSourceOptions {
    std::string site;
    std::vector<HostEntry> hosts;         // checked
    std::chrono::nanoseconds deadline{};  // as of the assembler
};

/// What the camera nodes of a site find, as frames without pictures (capture::FoundSilhouette). The
/// times of the frames are on this host's clock. Asks the hosts for their clocks and tells them how
/// to code textures, ten times a second.
class HostsSource final : public capture::FrameSource {
public:
    static Expected<std::unique_ptr<HostsSource>> open(const bus::Participant& participant,
                                                       const config::Rig& rig,
                                                       HostsSourceOptions options);
    ~HostsSource() override;

    const config::Rig& rig() const override { return rig_; }
    bool has_silhouettes() const override { return true; }
    bool is_live() const override { return true; }
    /// Camera nodes learn the empty room: kNotFound for each camera.
    std::vector<Expected<void>> show_background(const std::vector<std::size_t>& cameras,
                                                const BackgroundSink& sink,
                                                std::stop_token stop) override;
    Expected<void> run(std::stop_token stop, const Sink& sink) override;
    /// What the camera nodes report of their cameras. Thread-safe.
    std::vector<capture::CameraCounters> camera_counters() const override;

    /// How camera nodes shall code the colours from now on: of one of `send_every` instants, of
    /// which `sent` is one. Thread-safe.
    struct Wishes {
        int jpeg_quality = 86;
        int colour_divisor = 1;
        int send_every = 1;
        Timestamp sent{};
    };
    void set_wishes(const Wishes& wishes);

    /// Thread-safe.
    std::vector<bus::HostStatus> statuses() const;

private:
    struct Bus {
        bus::Reader<bus::CameraSilhouette> silhouettes;
        bus::Reader<bus::ClockAnswer> answers;
        bus::Reader<bus::CameraNodeStatus> nodes;
        bus::Writer<bus::SiteOrders> orders;
        bus::Waiter waiter;
    };

    HostsSource(const config::Rig& rig, HostsSourceOptions options, Bus bus);
    void give_orders(std::stop_token stop);
    void take(const Sink& sink);
    void take_answers();
    void take_statuses();
    void complain(const char* what, const bus::TakeReport& report);
    void log_events();

    config::Rig rig_;
    HostsSourceOptions options_;
    Bus bus_;
    std::vector<capture::CameraFrame> frames_;  // scratch
    app::log::OncePerSecond complaints_;

    mutable std::mutex mutex_;  // guards the members below
    HostTable table_;
    ClockEpoch own_clock_;
    std::uint64_t own_epoch_ = 0;
    bus::SiteOrders orders_;
    std::uint64_t first_valid_question_ = 0;  // asked since this host's clock was set
    std::vector<capture::CameraCounters> counters_;
};

}  // namespace atrium::hosts
