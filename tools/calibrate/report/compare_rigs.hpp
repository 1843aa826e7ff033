#pragma once

#include "core/config/rig.hpp"
#include "core/geometry/rigid_transform.hpp"

#include <string>
#include <utility>
#include <vector>

namespace atrium::calibrate {

/// How a camera of a new rig stands beside the same camera of an old one.
struct CameraMove {
    std::string name;
    double moved_m = 0.0;
    double turned_deg = 0.0;   // of what its pixels look at
    double focal_ratio = 1.0;  // new / old
    bool stays = false;        // within the accuracy of calibrations
};

/// A new rig beside an old one of the same room.
struct RigComparison {
    /// Lays the new rig on those cameras of the old one that stay.
    geometry::RigidTransform old_from_new;
    /// Distances between cameras, new / old (median); 1 with fewer than three common cameras.
    double length_ratio = 1.0;
    std::vector<CameraMove> moves;  // of the cameras in both, in the order of the new rig
    std::vector<std::string> only_in_old, only_in_new;
    /// Cameras that stand where the other one stood: cables, serials or names were exchanged.
    std::vector<std::pair<std::string, std::string>> exchanged;

    std::size_t num_staying() const;
    /// Most of three or more common cameras stay, so the frame of the old rig holds for the new.
    bool shares_frame() const;
};

/// Lays the new rig on the old one so that most cameras stay where they were: of the transforms
/// that lay one camera on itself, the one with the smallest sum of the others' moves, each cut off
/// at 10 cm, then the mean over the cameras that stay. Both rigs in metres; a rig is never scaled.
/// A camera that moved does not shift the others, as it would in a least-squares fit (Umeyama
/// 1991).
RigComparison compare_rigs(const config::Rig& old_rig, const config::Rig& new_rig);

/// The rig in the frame of the old one. Bounds are left out, as they are the old one's.
config::Rig in_frame_of_old(const config::Rig& new_rig, const RigComparison& comparison);

}  // namespace atrium::calibrate
