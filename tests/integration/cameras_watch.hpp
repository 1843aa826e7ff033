#pragma once

#include "core/app/log.hpp"
#include "site_node/capture/metaframe.hpp"
#include "tools/simulated_cameras/stamp.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

/// Records of `cameras_client`.
namespace atrium::cameras {

using Clock = std::chrono::steady_clock;
using Seconds = std::chrono::duration<double>;

constexpr std::uint64_t kMaxDescribed = 3;  // of metaframes that mix triggers

// Record of one camera, on the capture thread.
struct Presence {
    std::uint64_t num_seen = 0;
    Clock::time_point last;
    double longest_absence_s = 0.0;
};

// The capture thread's record of the stamps.
struct Watch {
    /// Stamps of one trigger differ by `max_apart` at most.
    Watch(std::size_t num_cameras, std::uint32_t max_apart)
        : cameras(num_cameras), max_stamps_apart(max_apart) {}

    bool are_of_one_trigger(std::uint32_t a, std::uint32_t b) const {
        return std::min(a - b, b - a) <= max_stamps_apart;
    }

    void look_at(const capture::Metaframe& metaframe) {
        const auto now = Clock::now();
        if (num_metaframes == 0) {
            for (Presence& camera : cameras) camera.last = now;
        }
        ++num_metaframes;
        std::optional<std::uint32_t> trigger;
        bool is_mixed = false;
        for (const capture::CameraFrame& frame : metaframe.frames) {
            if (frame.image.empty()) continue;
            const auto stamp = simulated_cameras::read_stamp(frame.image);
            if (!stamp) {
                ++num_unreadable;
                continue;
            }
            if (stamp->camera != frame.camera) ++num_wrong_camera;
            if (!trigger) trigger = stamp->trigger;
            if (!are_of_one_trigger(*trigger, stamp->trigger)) is_mixed = true;
            Presence& camera = cameras[frame.camera];
            ++camera.num_seen;
            camera.longest_absence_s =
                std::max(camera.longest_absence_s, Seconds(now - camera.last).count());
            camera.last = now;
        }
        if (is_mixed) {
            if (++num_mixed <= kMaxDescribed) describe(metaframe);
        }
        if (!trigger) return;
        if (last_trigger && static_cast<std::int32_t>(*trigger - *last_trigger) <= 0)
            ++num_backwards;
        if (!first_trigger) first_trigger = trigger;
        last_trigger = trigger;
    }

    // Triggers and times of the pictures, to find the reason of a failure.
    static void describe(const capture::Metaframe& metaframe) {
        std::string text;
        for (const capture::CameraFrame& frame : metaframe.frames) {
            const auto stamp = simulated_cameras::read_stamp(frame.image);
            if (!stamp) continue;
            text += fmt::format(" {}:{}{:+.1f}ms",
                                frame.camera,
                                stamp->trigger,
                                std::chrono::duration<double, std::milli>(frame.capture_time -
                                                                          metaframe.capture_time)
                                    .count());
        }
        app::log::warn("metaframe {} mixes triggers:{}", metaframe.frame_id, text);
    }

    void finish() {
        for (Presence& camera : cameras) {
            camera.longest_absence_s =
                std::max(camera.longest_absence_s, Seconds(Clock::now() - camera.last).count());
        }
    }

    std::vector<Presence> cameras;
    std::uint32_t max_stamps_apart;
    std::uint64_t num_metaframes = 0;
    std::uint64_t num_mixed = 0;
    std::uint64_t num_unreadable = 0;
    std::uint64_t num_wrong_camera = 0;
    std::uint64_t num_backwards = 0;
    std::optional<std::uint32_t> first_trigger, last_trigger;
};

// The worker's record of the results.
struct Output {
    std::uint64_t num_published = 0;
    std::uint64_t num_with_hull = 0;
    std::uint64_t num_failed = 0;
    double longest_gap_s = 0.0;
    std::vector<double> latencies_ms;
    std::vector<double> triangles;
};

inline double quantile(std::vector<double> values, double share) {
    if (values.empty()) return 0.0;
    std::sort(values.begin(), values.end());
    return values[static_cast<std::size_t>(share * static_cast<double>(values.size() - 1))];
}

}  // namespace atrium::cameras
