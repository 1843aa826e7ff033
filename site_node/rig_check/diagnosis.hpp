#pragma once

#include "site_node/rig_check/agreement.hpp"
#include "site_node/views/named_view.hpp"

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace atrium::rig_check {

enum class Cause : std::uint8_t {
    kInverted,     // site_from_camera was written
    kAxes,         // another axis convention
    kSwapped,      // the pictures or the extrinsics of cameras are exchanged
    kFocal,        // focal lengths or picture sizes are scaled
    kUndistorted,  // the pictures were undistorted before, the rig has the original lenses
    kTurned,       // the pictures of one camera or all are turned by 180 degrees
    kMirrored,     // they are mirrored left-right
    kFlipped,      // they are mirrored upside down
    kOneCamera,    // one camera contradicts all others otherwise
    kTwoCameras,   // two cameras do, and four or more others agree
    kUnknown,
};

struct Diagnosis {
    Cause cause = Cause::kUnknown;
    std::string text;                  // likely cause and cure
    double share = 0.0;                // of the silhouettes that is explained
    double share_if = 0.0;             // the same if the cause is true
    std::vector<std::string> cameras;  // that are concerned; empty: all
};

/// Below this share of explained silhouettes a rig is worth a diagnosis. Real rigs with real
/// silhouettes reach 0.95, and 0.85 with things in a picture that the others do not see.
inline constexpr double kPoorShare = 0.8;

/// Above it nothing is sought. In between only what is wrong with all cameras or with pairs of them
/// is, and more strictly: one camera may see things that the others do not.
inline constexpr double kFineShare = 0.95;

/// Above it nothing is sought where lenses distort much (`distort_much`). In between only whether
/// the pictures were undistorted before is: near the middle of the room that does little harm.
inline constexpr double kNearlyAllShare = 0.985;

/// True if the rig's distortion moves a corner of some picture by more than 4 px.
bool distort_much(std::span<const views::NamedView> views);

/// Finds why silhouettes of one instant do not fit together: tries what people get wrong (inverted
/// extrinsics, OpenGL's axes, exchanged cameras, scaled intrinsics, pictures without distortion,
/// pictures of all cameras or of one that were turned or mirrored, one or two cameras that moved),
/// and names what explains the silhouettes so much better that chance is out of the question.
/// nullopt if the silhouettes fit. Silhouettes of one instant may mislead: trust what several
/// instants say.
///
/// A person is nearly symmetric, so in the middle of a picture a mirrored one is not found. In a
/// ring with a plane of symmetry, pictures of all cameras that are mirrored look the same as
/// cameras that are exchanged across it: with one such pair the text says both.
///
/// Takes one measurement per hypothesis: some tenths of a second for 8 cameras, up to two seconds
/// for 24. `go_on` may stop it.
std::optional<Diagnosis> diagnose(std::span<const views::NamedView> views,
                                  const AgreementOptions& options,
                                  const std::function<bool()>& go_on = {});

}  // namespace atrium::rig_check
