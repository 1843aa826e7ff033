#include "site_node/hosts/host_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

namespace atrium::hosts {
namespace {

using std::chrono::nanoseconds;

// A host that is set back and forth must not fill the memory.
constexpr std::size_t kMostEpochs = 4;
constexpr std::size_t kDelays = 10;
constexpr nanoseconds kShortestSilence = std::chrono::milliseconds(250);
constexpr nanoseconds kLongestStart = std::chrono::seconds(3);
constexpr nanoseconds kLongestMeasurement = std::chrono::seconds(1);
constexpr nanoseconds kLongestDisorder = std::chrono::seconds(10);
constexpr nanoseconds kMostAhead = std::chrono::milliseconds(5);
constexpr std::size_t kMostStrangers = 32;  // that are named

std::vector<std::vector<Eigen::Vector2d>> contours_of(const bus::CameraSilhouette& silhouette) {
    std::vector<std::vector<Eigen::Vector2d>> contours;
    auto vertex = silhouette.vertices_px.begin();
    for (const std::uint32_t size : silhouette.contour_sizes) {
        auto& contour = contours.emplace_back();
        contour.reserve(size);
        for (std::uint32_t i = 0; i < size; ++i, ++vertex)
            contour.emplace_back((*vertex)[0], (*vertex)[1]);
    }
    return contours;
}

std::shared_ptr<const capture::FoundSilhouette> found_in(const bus::CameraSilhouette& silhouette) {
    auto found = std::make_shared<capture::FoundSilhouette>();
    found->contours_px = contours_of(silhouette);
    found->has_texture = silhouette.has_texture;
    found->texture_frame_id = silhouette.frame_id;
    found->texture_time = silhouette.capture_time;
    if (silhouette.is_view_shifted)
        found->view_shift_px.emplace(silhouette.view_shift_px[0], silhouette.view_shift_px[1]);
    found->num_contours_dropped = silhouette.num_contours_dropped;
    found->segmentation_ms = silhouette.segmentation_ms;
    found->polygons_ms = silhouette.polygons_ms;
    found->texture_ms = silhouette.texture_ms;
    found->colour_bytes = silhouette.colour_bytes;
    found->mask_bytes = silhouette.mask_bytes;
    return found;
}

}  // namespace

HostTable::HostTable(std::vector<std::string> cameras,
                     const std::vector<HostEntry>& hosts,
                     const HostTableOptions& options)
    : cameras_(std::move(cameras)), options_(options), owners_(cameras_.size()) {
    for (std::size_t i = 0; i < hosts.size(); ++i) {
        const HostEntry& entry = hosts[i];
        if (entry.cameras.empty() && !entry.takes_any) continue;
        Host& host = hosts_.emplace_back();
        host.entry = entry;
        if (i < options.parts.size()) host.part = options.parts[i];
        for (const std::string& camera : entry.cameras) {
            const auto found = std::ranges::find(cameras_, camera);
            if (found != cameras_.end())
                owners_[static_cast<std::size_t>(found - cameras_.begin())] = hosts_.size() - 1;
        }
    }
    const auto num_any =
        std::ranges::count_if(hosts_, [](const Host& host) { return host.entry.takes_any; });
    last_pictures_.resize(cameras_.size());
    for (std::size_t camera = 0; camera < cameras_.size(); ++camera)
        is_open_.push_back(num_any > 1 && !owners_[camera]);
    for (std::size_t i = 0; i < hosts_.size(); ++i) {
        if (!hosts_[i].entry.takes_any || num_any > 1) continue;
        for (auto& owner : owners_) owner = owner.value_or(i);
    }
}

nanoseconds HostTable::silence() const { return std::max(5 * options_.period, kShortestSilence); }

HostTable::Host* HostTable::owner_of(const bus::CameraSilhouette& silhouette, Time now) {
    if (silhouette.camera >= cameras_.size()) return nullptr;
    if (is_open_[silhouette.camera]) return claim(silhouette, now);
    if (!owners_[silhouette.camera]) return nullptr;
    Host& host = hosts_[*owners_[silhouette.camera]];
    return host.entry.name == silhouette.host ? &host : nullptr;
}

// Only pictures claim a camera: each auto host says that it lacks those of the others.
HostTable::Host* HostTable::claim(const bus::CameraSilhouette& silhouette, Time now) {
    const auto found = std::ranges::find_if(hosts_, [&](const Host& host) {
        return host.entry.takes_any && host.entry.name == silhouette.host;
    });
    if (found == hosts_.end()) return nullptr;
    auto& owner = owners_[silhouette.camera];
    const auto index = static_cast<std::size_t>(found - hosts_.begin());
    Time& last = last_pictures_[silhouette.camera];
    if (owner != index) {
        if (!silhouette.has_picture || (owner && now - last <= silence())) return nullptr;
        owner = index;
        events_.push_back({false,
                           fmt::format("camera_found host={} camera={}",
                                       found->entry.name,
                                       cameras_[silhouette.camera])});
    }
    if (silhouette.has_picture) last = now;
    return &*found;
}

void HostTable::add(bus::CameraSilhouette silhouette,
                    Timestamp now,
                    Time arrival,
                    std::vector<capture::CameraFrame>& out) {
    Host* const host = owner_of(silhouette, arrival);
    if (host == nullptr) {
        const bool is_of_another =
            silhouette.camera < cameras_.size() && is_open_[silhouette.camera];
        if (!is_of_another && strangers_.size() < kMostStrangers &&
            strangers_.emplace(silhouette.host, silhouette.camera).second)
            events_.push_back({true,
                               fmt::format("host_unknown host={} camera={} reason=\"the site's "
                                           "file gives this camera to another host\" advice=\"use "
                                           "one file on all hosts of the site\"",
                                           silhouette.host,
                                           silhouette.camera)});
        return;
    }
    host->last_heard = arrival;
    host->has_grace = false;
    host->epoch = silhouette.clock_epoch;
    host->has_our_part = silhouette.rig == host->part;
    enter(*host, judge(*host, arrival), arrival);
    const bool knows_clock =
        host->state == bus::HostState::kInUse || host->state == bus::HostState::kLate;
    // the offset is small now
    const Timestamp time =
        knows_clock ? silhouette.capture_time + -host->clock.offset : Timestamp{};
    // a picture of the future would make those of the others late
    if (!knows_clock || now - time > kLongestDisorder ||
        time - now > host->clock.error + kMostAhead) {
        ++host->num_left_out;
        return;
    }
    if (host->state == bus::HostState::kLate) ++host->num_left_out;
    host->delays.push_back(now - time);
    if (host->delays.size() > kDelays) host->delays.pop_front();
    capture::CameraFrame frame;
    frame.camera = silhouette.camera;
    frame.capture_time = time;
    if (silhouette.has_picture) frame.found = found_in(silhouette);
    out.push_back(std::move(frame));
    for (std::size_t camera = 0; camera < cameras_.size(); ++camera) {
        if (is_in_use(camera)) continue;
        capture::CameraFrame lost;
        lost.camera = camera;
        lost.capture_time = time;
        if (camera != silhouette.camera) out.push_back(std::move(lost));
    }
}

void HostTable::add(const bus::ClockAnswer& answer, Timestamp returned, Time arrival) {
    for (Host& host : hosts_) {
        if (host.entry.name != answer.host) continue;
        if (host.clocks.size() >= kMostEpochs && !host.clocks.contains(answer.clock_epoch)) {
            auto clock = host.clocks.begin();
            if (clock->first == host.epoch) ++clock;
            host.clocks.erase(clock);
        }
        host.clocks[answer.clock_epoch].add(
            {answer.asked, answer.received, answer.answered, returned}, arrival);
    }
}

bool HostTable::has_camera(const std::string& host, std::size_t camera) const {
    return camera < owners_.size() && owners_[camera] &&
           hosts_[*owners_[camera]].entry.name == host;
}

void HostTable::forget_clocks(Time now) {
    forgotten_ = now;
    for (Host& host : hosts_) {
        host.clocks.clear();
        host.delays.clear();  // some by the former clock
    }
}

bus::HostState HostTable::judge(Host& host, Time now) const {
    using State = bus::HostState;
    if (!host.last_heard || now - *host.last_heard > silence()) return State::kMissing;
    if (!host.has_our_part) return State::kOtherRig;
    // metaframes still wait for pictures by the former clock
    if (forgotten_ && now - *forgotten_ <= options_.deadline) return State::kClockUnknown;
    const auto clock = host.clocks.find(host.epoch);
    const auto estimate = clock == host.clocks.end() ? std::nullopt : clock->second.estimate(now);
    if (!estimate || estimate->error > options_.period / 8) return State::kClockUnknown;
    host.clock = *estimate;
    const nanoseconds quarter = options_.period / 4;
    // near the limit it must not come and go
    const nanoseconds limit = host.state == State::kClockWrong ? quarter * 4 / 5 : quarter;
    if (std::chrono::abs(estimate->offset) > limit) return State::kClockWrong;
    // The assembler waits from the first picture on: what counts is how much later than the others.
    std::optional<nanoseconds> quickest;
    for (const Host& other : hosts_) {
        // of the others the delays are old
        if (other.state != State::kInUse && other.state != State::kLate) continue;
        if (&other == &host || other.delays.empty()) continue;
        const nanoseconds delay = std::max(*std::ranges::min_element(other.delays), nanoseconds(0));
        quickest = std::min(quickest.value_or(delay), delay);
    }
    const auto is_late = [&](nanoseconds delay) {
        return quickest && delay - *quickest > options_.deadline;
    };
    if (host.delays.size() == kDelays) {
        if (std::ranges::all_of(host.delays, is_late)) return State::kLate;
        if (host.state == State::kLate && std::ranges::any_of(host.delays, is_late))
            return State::kLate;
    }
    return State::kInUse;
}

std::string HostTable::names_of_cameras(const Host& host) const {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < cameras_.size(); ++i) {
        if (owners_[i] && &hosts_[*owners_[i]] == &host) names.push_back(cameras_[i]);
    }
    return fmt::format("{}", fmt::join(names, " "));
}

std::string HostTable::why(const Host& host) const {
    const double offset_ms = milliseconds(host.clock.offset);
    switch (host.state) {
        case bus::HostState::kClockWrong:
            return fmt::format(
                "reason=\"its clock is {:.1f} ms {} this host's, more than a quarter of the "
                "period, {:.1f} ms\" advice=\"let chrony or PTP set both clocks: chronyc tracking "
                "on both hosts, atrium doctor\"",
                std::abs(offset_ms),
                offset_ms > 0.0 ? "ahead of" : "behind",
                milliseconds(options_.period) / 4.0);
        case bus::HostState::kClockUnknown:
            return "reason=\"its clock is not measured yet, or the network delays the measurement "
                   "by more than a quarter of the period\"";
        case bus::HostState::kOtherRig:
            return "reason=\"its rig, its rate or its cameras in the site's file differ from this "
                   "host's\" advice=\"copy the site's file and its rig to all hosts, and start "
                   "camera_node there anew\"";
        case bus::HostState::kLate:
            return fmt::format(
                "reason=\"its silhouettes come {:.0f} ms after their pictures, later than "
                "those of the others by more than capture.deadline_ms\" advice=\"atrium doctor on "
                "that host\"",
                host.delays.empty() ? 0.0 : milliseconds(host.delays.back()));
        default:
            return "reason=\"nothing comes from it\" advice=\"is camera_node running there? its "
                   "first "
                   "start may prepare pictures for a minute; is the network up?\"";
    }
}

void HostTable::enter(Host& host, bus::HostState state, Time now) {
    if (host.state != state || !host.since) {
        host.state = state;
        host.since = now;
        host.was_told = false;
        if (state == bus::HostState::kMissing) host.delays.clear();
    }
    tell(host, now);
}

// Tells of a state once. At the start a host may be missing for a while, and its clock is measured
// within a second.
void HostTable::tell(Host& host, Time now) {
    using State = bus::HostState;
    const bool is_start = host.state == State::kMissing && !host.was_in_use;
    const nanoseconds patience = is_start                             ? kLongestStart
                                 : host.state == State::kClockUnknown ? kLongestMeasurement
                                                                      : nanoseconds(0);
    if (host.was_told || now - *host.since < patience) return;
    host.was_told = true;
    if (host.state != State::kInUse) {
        events_.push_back({true,
                           fmt::format("host_left_out host={} cameras=\"{}\" {}",
                                       host.entry.name,
                                       names_of_cameras(host),
                                       why(host))});
        return;
    }
    host.was_in_use = true;
    events_.push_back({false,
                       fmt::format("host_in_use host={} cameras=\"{}\" clock_offset_ms={:.2f} "
                                   "clock_error_ms={:.2f}",
                                   host.entry.name,
                                   names_of_cameras(host),
                                   milliseconds(host.clock.offset),
                                   milliseconds(host.clock.error))});
}

// This program stood still: what the hosts sent meanwhile is about to be taken.
void HostTable::give_grace(Time now) {
    for (Host& host : hosts_) {
        if (!host.last_heard || now - *host.last_heard <= silence()) continue;
        if (host.state != bus::HostState::kMissing && !std::exchange(host.has_grace, true))
            host.last_heard = now - silence() / 2;
    }
}

void HostTable::look(Time now) {
    if (last_look_ && now - *last_look_ > silence()) give_grace(now);
    last_look_ = now;
    for (Host& host : hosts_) enter(host, judge(host, now), now);
}

std::vector<HostEvent> HostTable::take_events() { return std::exchange(events_, {}); }

bool HostTable::is_in_use(std::size_t camera) const {
    return owners_[camera] && hosts_[*owners_[camera]].state == bus::HostState::kInUse;
}

std::vector<bus::HostStatus> HostTable::statuses() const {
    std::vector<bus::HostStatus> statuses;
    for (std::size_t i = 0; i < hosts_.size(); ++i) {
        const Host& host = hosts_[i];
        const auto num_cameras = std::ranges::count(owners_, std::optional<std::size_t>(i));
        statuses.push_back({.name = host.entry.name,
                            .state = host.state,
                            .clock_offset_ms = milliseconds(host.clock.offset),
                            .clock_error_ms = milliseconds(host.clock.error),
                            .num_cameras = static_cast<std::uint32_t>(num_cameras),
                            .num_left_out = host.num_left_out});
    }
    return statuses;
}

}  // namespace atrium::hosts
