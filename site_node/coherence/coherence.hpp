#pragma once

#include "site_node/coherence/camera_fit.hpp"
#include "site_node/coherence/other_lenses.hpp"
#include "site_node/coherence/tangency.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

namespace atrium::coherence {

enum class Verdict : std::uint8_t {
    kTooLittle,   // too few instants with somebody who moves, seen by three cameras
    kCoherent,    // nothing certain is wrong
    kMoved,       // one camera was moved since the calibration
    kLate,        // one camera's pictures are of another instant
    kIncoherent,  // the silhouettes contradict the rig, but no single camera explains it
    kLenses,      // they do, and one factor of all focal lengths explains it (CoherenceWatch)
};

/// How far one camera agrees with the others.
struct CameraCoherence {
    std::size_t num_tangencies = 0;
    double rms_px = 0.0;  // robust, of its tangencies, without a dilation of its silhouettes
    double share = 1.0;   // of its tangencies within kFits_px
};

/// One camera, and what is wrong with it.
struct NamedFault {
    std::size_t camera = 0;  // index into the rig
    /// What was found out of the camera's motion since the calibration. A part that the silhouettes
    /// do not show for certain is missing; if either one alone explains all, `is_either` is true.
    std::optional<double> turned_deg, moved_mm;
    bool is_either = false;
    double late_instants = 0.0;  // kLate: its pictures show what was so many instants before
    double effect_px = 0.0;      // RMS in its pictures
    double rms_after_px = 0.0;   // of its tangencies, without the fault
    geometry::RigidTransform camera_from_site;  // of a camera that was moved: where it is now
};

struct Report {
    Verdict verdict = Verdict::kTooLittle;
    std::size_t num_sights = 0;
    double rms_px = 0.0;  // robust, of all tangencies
    std::vector<CameraCoherence> cameras;
    std::optional<NamedFault> fault;    // of kMoved and kLate
    std::optional<OtherLenses> lenses;  // of kLenses
};

inline constexpr double kFits_px = 2.0;

/// Judges a rig from the silhouettes of people who move, over a window of instants. Names a camera
/// only if it alone explains the errors: at least `kLeastEffect_px`, in all parts of the window,
/// much better than any other camera, and as well as the others agree. No threads; not thread-safe.
class Coherence {
public:
    /// `cameras`: of the rig, at least two.
    explicit Coherence(std::vector<geometry::CalibratedCamera> cameras,
                       std::size_t most_sights = kWindow);

    /// Adds an instant, the newest; the oldest leaves the window. Instants about half a second
    /// apart say most. An instant at which nothing has moved since the last is left out: false.
    bool add(const Sight& sight);
    void clear();

    Report judge() const;
    /// Tries whether other lenses explain the errors of the window (find_other_lenses): slow.
    std::optional<OtherLenses> other_lenses() const;

    static constexpr std::size_t kWindow = 48;
    static constexpr std::size_t kLeastSights = 18;
    static constexpr std::size_t kLeastTangencies = 40;  // of a camera
    static constexpr double kLeastEffect_px = 0.7;

private:
    struct Instant {
        std::vector<Tangency> tangencies;
        Sight sight;  // without the instant before
    };
    bool has_moved(const Sight& sight);

    std::vector<geometry::CalibratedCamera> cameras_;
    std::size_t most_sights_;
    std::deque<Instant> window_;
    std::vector<Eigen::Vector2d> last_middles_px_;
};

}  // namespace atrium::coherence
