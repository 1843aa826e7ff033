#pragma once

#include "core/geometry/aabb.hpp"
#include "site_node/rig_check/agreement.hpp"
#include "site_node/rig_check/floor_check.hpp"
#include "site_node/views/named_view.hpp"

#include <chrono>
#include <cstddef>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace atrium::rig_check {

/// One metaframe: the silhouettes of all cameras that delivered, and the hull's size.
struct Look {
    std::vector<views::NamedView> views;
    geometry::Aabb hull_extent;  // empty: no hull, or an empty one
    double hull_volume_m3 = 0.0;
    bool is_hull_whole = true;  // false: without the hulls of other hosts, it shows no size
    std::optional<Footing> footing;
    /// Cameras whose pictures show the learned room elsewhere.
    struct Shifted {
        std::string camera;
        double shift_px = 0.0;
        double turn_rad = 0.0;  // of the camera, if nothing else shifts it
    };
    std::vector<Shifted> shifted{};
};

/// Judges the rig of a running site from one metaframe about once a second. A finding needs several
/// looks, so a person who walks through a door causes none, and is repeated rarely. Makes no
/// threads; not thread-safe.
class RigWatch {
public:
    using Clock = std::chrono::steady_clock;
    static constexpr std::chrono::minutes kRepeat{10};

    explicit RigWatch(AgreementOptions options) : options_(options) {}

    /// Returns the lines to log as warnings; that people are small, which children are, only once.
    /// `go_on`: false ends a long diagnosis.
    std::vector<std::string> look(const Look& look,
                                  Clock::time_point now,
                                  const std::function<bool()>& go_on = {});

    /// How many looks in a row found nothing to doubt.
    std::size_t num_good_looks() const { return num_good_looks_; }

    /// The reason of the first finding that was reported and holds: it came back within the last
    /// kStandingLooks looks with somebody. One that explains the others (`is_explained`) goes
    /// first. Empty without one. That people are small, or a hull empty, may be meant, and is none.
    std::string standing_reason() const;
    static constexpr std::size_t kStandingLooks = 90;
    /// True if a mistake that explains the silhouettes holds, or was seen in the last looks, such
    /// as swapped cameras or turned pictures: what else is wrong with poses and floor then follows
    /// from it.
    bool is_explained() const;

    /// Returns the lines for the end of a run: findings with too few looks to report them before.
    std::vector<std::string> finish();

    /// "silhouettes looks=12 explained=0.96 fit=good worst=cam3:0.91 cut=0.00 height_m=1.78"; empty
    /// if nobody was seen. `fit`: good from kFineShare on, fair from kPoorShare on, else poor; not
    /// good if the rig is in doubt otherwise.
    /// `cut`: the share of the silhouettes that bounds or the borders of pictures cut. `height_m`:
    /// the median height of people; missing if none was seen from the feet up.
    std::string summary(bool is_rig_in_doubt = false) const;

    /// The reason of the last line that `look` or `finish` returned, if it may explain a hull that
    /// is always empty; empty without any.
    const std::string& last_reason() const { return last_reason_; }

private:
    struct Camera {
        std::size_t rays = 0;
        std::size_t explained = 0;
        std::size_t silent = 0;  // rays cut by bounds or by the borders of pictures
        std::size_t looks_with_somebody = 0;
        std::size_t looks_only_others = 0;  // while others saw somebody
    };
    static constexpr const char* kShifted = "shifted ";  // begin of keys of findings
    struct Finding {
        std::string line;
        std::string reason;
        std::size_t votes = 0;
        std::size_t needed = 1;
        std::optional<Clock::time_point> reported;
        std::size_t voted_at = 0;                // num_looks_
        std::optional<std::size_t> standing_at;  // num_looks_ when it was first reported
        bool explains = false;                   // see `is_explained`
    };
    // The share of rays of one look that the bounds cut.
    struct Cut {
        std::size_t rays = 0;
        std::size_t cut = 0;
    };

    Finding& vote(const std::string& key,
                  std::size_t needed,
                  const std::string& event,
                  const std::string& reason);
    bool stands(const Finding& finding) const;
    void judge_shifted(const Look& look);
    void judge_blind_cameras(const Look& look, const Agreement& agreement);
    void judge_outside(const Look& look, const Agreement& agreement);
    void judge_agreement(const Look& look,
                         const Agreement& agreement,
                         Clock::time_point now,
                         const std::function<bool()>& go_on);
    void judge_bounds(const Look& look, const Agreement& agreement);
    void judge_size(const Look& look, const Agreement& agreement);
    void judge_smallness(const Look& look, const Agreement& agreement);
    void judge_floor(const Look& look);
    void judge_height(const Look& look, const Agreement& agreement);
    void judge_lowness(const Look& look, const Agreement& agreement);

    AgreementOptions options_;
    bool has_seen_large_ = false;  // a hull that a person may have: the scale is right
    std::map<std::string, Camera> cameras_;
    std::map<std::string, Finding> findings_;
    std::size_t num_looks_ = 0;  // with somebody
    std::size_t num_good_looks_ = 0;
    std::optional<Clock::time_point> last_diagnosis_;
    std::size_t num_diagnoses_ = 0;
    std::deque<double> recent_shares_;
    std::deque<Cut> recent_cuts_;
    FloorCheck floor_;
    std::vector<double> heights_m_;        // of people, at most kMostHeights
    std::vector<double> whole_heights_m_;  // in pictures that show more than them, as many
    std::string last_reason_;
};

}  // namespace atrium::rig_check
