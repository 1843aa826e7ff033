#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace atrium::capture {

/// Settings of one camera. A default value leaves the camera's own setting or is determined at
/// connection.
struct CameraSettings {
    std::string pixel_format;    // one of camera_pixel_formats(); empty: the camera's own
    double exposure_us = 0.0;    // 0: the camera's own
    double gain_db = -1.0;       // below 0: the camera's own
    std::string white_balance;   // "off", "auto-once" or "RED,BLUE"; empty: the camera's own
    std::string trigger_source;  // line of the external trigger; empty: the camera's first line
    int packet_size = 0;         // GigE Vision [bytes]; 0: as large as the MTU allows
    std::int64_t packet_delay_ns = -1;  // GigE Vision, between packets; below 0: the camera's
    /// Transmitted part of the sensor: x, y, width, height [px]. Empty: from (0, 0), in the size of
    /// the rig.
    std::optional<std::array<int, 4>> region_px;
};

/// Returns the settings of `own` where set, else those of `common`.
CameraSettings merged(const CameraSettings& common, const CameraSettings& own);

/// GenICam names that `CameraSettings::pixel_format` accepts.
const std::vector<std::string>& camera_pixel_formats();

/// One camera of the rig and how to find it.
struct CameraEntry {
    std::string name;     // as in the rig
    std::string serial;   // at least one of serial and address
    std::string address;  // IPv4
    CameraSettings settings;
};

enum class TriggerMode : std::uint8_t {
    kExternal,  // an input line of each camera
    kSoftware,  // the site triggers all cameras at once
    kFreeRun,   // each camera follows its own clock
};

/// Options that all cameras of a site share.
struct CamerasOptions {
    std::vector<CameraEntry> cameras;
    CameraSettings common;
    TriggerMode trigger = TriggerMode::kSoftware;
    bool is_trigger_aligned = false;      // beats of the software trigger: Pace::Phase::kAligned
    std::size_t min_cameras = 0;          // required at the start; 0: all
    std::chrono::nanoseconds deadline{};  // longest time that the site keeps a picture waiting
    int num_buffers = 0;                  // per camera; 0: enough for rate and deadline
    int realtime_priority = 10;           // of the threads that receive packets; 0: none
    int silent_periods = 10;        // without a picture; then, but not before 0.5 s, it is lost
    bool use_packet_socket = true;  // if permitted (cap_net_raw)
};

}  // namespace atrium::capture
