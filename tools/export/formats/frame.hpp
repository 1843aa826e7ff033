#pragma once

#include "core/base/timestamp.hpp"
#include "core/geometry/rigid_transform.hpp"

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace atrium::exporting {

/// What every exported file says of itself.
struct ExportFacts {
    std::string site;
    std::string frame_of_reference;  // "site alice" or "world studio"
    double rate_hz = 0.0;            // of the frames, the median
    std::string source;              // the recording
    std::string begin_utc;           // when the first frame was captured
    std::string colours_for;         // "surface normals" or "camera path"
    std::string generator;           // "Atrium 0.1.0"
};

/// "metres, right-handed, +Z up": of formats that keep Atrium's own axes.
inline constexpr const char* kOwnAxes = "right-handed, +Z up";

/// A key of a camera's way, in the frame of reference of the export.
struct CameraKey {
    double time_s = 0.0;                         // since the first frame
    geometry::RigidTransform frame_from_camera;  // of a camera that looks along its +Z, +Y is down
};

/// A camera path to export.
struct CameraPath {
    double fov_rad = 0.8;         // vertical
    double aspect = 16.0 / 9;     // width by height
    std::vector<CameraKey> keys;  // by rising time
};

struct FrameTime {
    std::size_t number = 1;    // in the export
    double time_s = 0.0;       // since the first frame
    double recording_s = 0.0;  // since the beginning of the recording
    Timestamp capture_time;
};

/// A frame in the bytes of a format, made on any thread.
struct EncodedFrame {
    FrameTime time;
    std::vector<std::uint8_t> mesh;     // empty: nobody is there
    std::vector<std::uint8_t> picture;  // JPEG; empty: none
    // of the coded mesh, for glTF
    std::uint32_t num_vertices = 0;
    std::uint32_t num_triangles = 0;
    Eigen::Vector3f low = Eigen::Vector3f::Zero();
    Eigen::Vector3f high = Eigen::Vector3f::Zero();
};

/// What was written.
struct Written {
    std::vector<std::filesystem::path> files;
    std::uint64_t bytes = 0;
};

}  // namespace atrium::exporting
