#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace atrium::capture {

/// How one camera is set up. Whatever has its default stays as the camera has it, or is found out.
struct CameraSettings {
    std::string pixel_format;    // one of camera_pixel_formats(); empty: the camera's
    double exposure_us = 0.0;    // 0: the camera's
    double gain_db = -1.0;       // below 0: the camera's
    std::string white_balance;   // "off", "auto-once" or "RED,BLUE"; empty: the camera's
    std::string trigger_source;  // line of the external trigger; empty: the camera's first line
    int packet_size = 0;         // GigE Vision [bytes]; 0: as large as the interface's MTU allows
    std::int64_t packet_delay_ns = -1;  // GigE Vision, between packets; below 0: the camera's
    /// Part of the sensor that is sent: x, y, width, height [px]. None: from (0, 0), as large as
    /// the rig says.
    std::optional<std::array<int, 4>> region_px;
};

/// The settings of `own` where it has any, else those of `common`.
CameraSettings merged(const CameraSettings& common, const CameraSettings& own);

/// Names that `CameraSettings::pixel_format` may have, in the words of GenICam.
const std::vector<std::string>& camera_pixel_formats();

/// One camera of the rig, and where it is.
struct CameraEntry {
    std::string name;     // as in the rig
    std::string serial;   // at least one of serial and address
    std::string address;  // IPv4
    CameraSettings settings;
};

enum class TriggerMode : std::uint8_t {
    kExternal,  // by a line of each camera
    kSoftware,  // by the site, all at once
    kFreeRun,   // each by its own clock
};

/// What is common to the cameras of a site.
struct CamerasOptions {
    std::vector<CameraEntry> cameras;
    CameraSettings common;
    TriggerMode trigger = TriggerMode::kSoftware;
    std::size_t min_cameras = 0;          // so many have to be there at the start; 0: all
    std::chrono::nanoseconds deadline{};  // how long the site may keep a picture waiting
    int num_buffers = 0;                  // per camera; 0: enough for rate and deadline
    int realtime_priority = 10;           // of the threads that receive packets; 0: none
    int silent_periods = 10;              // a camera without a picture for so long is lost
    bool use_packet_socket = true;        // where permitted (cap_net_raw)
};

}  // namespace atrium::capture
