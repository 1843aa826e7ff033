#include "site_node/hosts/region_hosts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>

namespace atrium::hosts {
namespace {

using Clock = std::chrono::steady_clock;

void add_camera(std::uint32_t camera,
                const std::vector<std::vector<Eigen::Vector2d>>& contours_px,
                bus::RegionOrder& order) {
    order.cameras.push_back(camera);
    order.contour_counts.push_back(static_cast<std::uint32_t>(contours_px.size()));
    for (const auto& contour : contours_px) {
        order.contour_sizes.push_back(static_cast<std::uint32_t>(contour.size()));
        for (const Eigen::Vector2d& vertex : contour)
            order.vertices_px.push_back({vertex.x(), vertex.y()});
    }
}

}  // namespace

std::string order_part(const std::string& site, const std::string& host) {
    return site + "/" + host;
}

Expected<std::unique_ptr<RegionHosts>> RegionHosts::open(const bus::Participant& participant,
                                                         RegionHostsOptions options) {
    std::vector<bus::Writer<bus::RegionOrder>> orders;
    for (const RegionHost& host : options.hosts) {
        auto writer =
            bus::Writer<bus::RegionOrder>::create(participant, order_part(options.site, host.name));
        if (!writer) return tl::unexpected(writer.error());
        orders.push_back(std::move(*writer));
    }
    auto meshes = bus::Reader<bus::RegionMeshes>::create(participant, options.site);
    if (!meshes) return tl::unexpected(meshes.error());
    auto waiter = bus::Waiter::create(participant);
    if (!waiter) return tl::unexpected(waiter.error());
    waiter->add(*meshes);
    return std::unique_ptr<RegionHosts>(new RegionHosts(
        std::move(options), {std::move(orders), std::move(*meshes), std::move(*waiter)}));
}

RegionHosts::RegionHosts(RegionHostsOptions options, Bus bus)
    : options_(std::move(options)),
      bus_(std::move(bus)),
      num_orders_(options_.hosts.size()),
      failures_(options_.hosts.size()),
      table_(options_.hosts, options_.period) {
    for (const RegionHost& host : options_.hosts) {
        auto& cameras = cameras_.emplace_back();
        for (const std::uint32_t region : host.regions)
            cameras.insert(
                cameras.end(), options_.cameras[region].begin(), options_.cameras[region].end());
        std::ranges::sort(cameras);
        cameras.erase(std::unique(cameras.begin(), cameras.end()), cameras.end());
    }
}

void RegionHosts::order(const bus::FrameKey& frame,
                        std::span<const hull::SilhouetteView> views,
                        std::span<const std::uint8_t> delivered) {
    std::vector<bool> is_connected;
    for (const auto& writer : bus_.orders) is_connected.push_back(writer.num_readers() > 0);
    frame_ = frame;
    {
        const std::lock_guard lock(mutex_);
        table_.begin(frame, is_connected, Clock::now());
    }
    for (std::size_t i = 0; i < options_.hosts.size(); ++i) {
        failures_[i].clear();
        if (!wants_order(i)) continue;
        bus::RegionOrder order;
        order.site = options_.site;
        order.host = options_.hosts[i].name;
        order.number = num_orders_[i] + 1;
        order.frame_id = frame.frame_id;
        order.capture_time = frame.capture_time;
        order.settings = options_.settings;
        for (const std::uint32_t camera : cameras_[i]) {
            if (delivered[camera] != 0) add_camera(camera, views[camera].contours, order);
        }
        const auto written = bus_.orders[i].write(order);
        if (written) {
            ++num_orders_[i];
            continue;
        }
        failures_[i] = written.error().message;
        const std::lock_guard lock(mutex_);
        table_.not_sent(i);
    }
}

bool RegionHosts::wants_order(std::size_t host) const {
    const std::lock_guard lock(mutex_);
    return table_.wants_order(host);
}

// Whether an answer has each region of its host and no other, and all are of our rig.
bool RegionHosts::is_ours(const bus::RegionMeshes& answer, const RegionHost& host) const {
    return answer.regions.size() == host.regions.size() &&
           std::ranges::all_of(answer.regions, [&](const bus::RegionHull& hull) {
               return hull.outcome != bus::RegionOutcome::kOtherRig &&
                      std::ranges::find(host.regions, hull.region) != host.regions.end();
           });
}

void RegionHosts::take_answers(std::vector<std::optional<bus::RegionMeshes>>& answers) {
    const auto on_answer = [&](bus::RegionMeshes&& answer) {
        if (answer.site != options_.site) return;
        const auto host = std::ranges::find(options_.hosts, answer.host, &RegionHost::name);
        if (host == options_.hosts.end()) {
            complaints_.warn(fmt::format(
                "meshes_rejected host={} reason=\"the site's file gives this host no regions\" "
                "advice=\"use one file on all hosts of the site\"",
                answer.host));
            return;
        }
        const auto index = static_cast<std::size_t>(host - options_.hosts.begin());
        const std::lock_guard lock(mutex_);
        if (!is_ours(answer, *host))
            table_.refused(index, Clock::now());
        else if (table_.answered(index, {answer.frame_id, answer.capture_time}, Clock::now()))
            answers[index] = std::move(answer);
    };
    // a program that ends need not be waited for
    const auto on_gone = [&](const bus::RegionMeshes& key, bus::Ending) {
        const auto host = std::ranges::find(options_.hosts, key.host, &RegionHost::name);
        if (key.site != options_.site || host == options_.hosts.end()) return;
        const std::lock_guard lock(mutex_);
        table_.gone(static_cast<std::size_t>(host - options_.hosts.begin()), Clock::now());
    };
    const auto report = bus_.meshes.take(on_answer, on_gone);
    if (report.num_rejected > 0)
        complaints_.warn(fmt::format(
            "meshes_rejected num={} first=\"{}\"", report.num_rejected, report.first_rejection));
}

bus::RegionMeshes RegionHosts::without_answer(std::size_t host) const {
    bus::RegionMeshes failed;
    failed.site = options_.site;
    failed.host = options_.hosts[host].name;
    failed.frame_id = frame_.frame_id;
    failed.capture_time = frame_.capture_time;
    failed.reason = failures_[host];
    if (failed.reason.empty()) {
        const std::lock_guard lock(mutex_);
        failed.reason = table_.why_without_answer(host);
    }
    for (const std::uint32_t region : options_.hosts[host].regions)
        failed.regions.push_back({region, bus::RegionOutcome::kFailed, 0});
    failed.left_out.num_regions_failed = failed.regions.size();
    return failed;
}

std::vector<bus::RegionMeshes> RegionHosts::collect() {
    std::vector<std::optional<bus::RegionMeshes>> answers(options_.hosts.size());
    while (true) {
        take_answers(answers);
        std::optional<RegionTable::Time> until;
        const auto now = Clock::now();
        {
            const std::lock_guard lock(mutex_);
            until = table_.waits_until(now);
        }
        if (!until) break;
        bus_.waiter.wait(std::chrono::ceil<std::chrono::milliseconds>(*until - now));
    }
    std::vector<HostEvent> events;
    {
        const std::lock_guard lock(mutex_);
        table_.end(Clock::now());
        events = table_.take_events();
    }
    for (const HostEvent& event : events) log(event);
    std::vector<bus::RegionMeshes> all;
    for (std::size_t i = 0; i < answers.size(); ++i) {
        all.push_back(answers[i] ? std::move(*answers[i]) : without_answer(i));
        if (answers[i] && !all[i].reason.empty())
            failed_.warn(all[i].reason,
                         fmt::format("regions_failed host={} failed={} reason=\"{}\"",
                                     all[i].host,
                                     all[i].left_out.num_regions_failed,
                                     all[i].reason));
    }
    return all;
}

std::vector<bus::HostStatus> RegionHosts::statuses() const {
    std::vector<bool> is_connected;
    for (const auto& writer : bus_.orders) is_connected.push_back(writer.num_readers() > 0);
    const std::lock_guard lock(mutex_);
    return table_.statuses(is_connected, Clock::now());
}

}  // namespace atrium::hosts
