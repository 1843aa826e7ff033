#include "site_node/rig_check/diagnosis.hpp"

#include "site_node/rig_check/flips.hpp"
#include "site_node/rig_check/rig_geometry.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <utility>

namespace atrium::rig_check {
namespace {

// A cause is believed if what remains unexplained shrinks to this share, and little remains.
constexpr double kResidualShare = 0.4;
constexpr double kStrictResidualShare = 0.3;  // of silhouettes that fit not too badly as they are
constexpr double kGoodShare = 0.8;
constexpr double kAlike = 0.02;     // shares that differ by less prefer neither cause
constexpr double kMostLost = 0.05;  // by a camera that agrees, of the share without it
constexpr std::size_t kMinRays = 60;
constexpr std::size_t kRaysPerRig = 640;
constexpr std::size_t kLeastRays = 24;
// Of more cameras only those that contradict most are exchanged in pairs.
constexpr std::size_t kMaxExchanged = 9;
constexpr std::size_t kLeastForTwo = 6;  // cameras: four others agree by no chance
constexpr std::array<double, 6> kScales{0.5, 2.0 / 3.0, 0.75, 4.0 / 3.0, 1.5, 2.0};

constexpr double kMuchDistortion_px = 4.0;

using Views = std::vector<hull::SilhouetteView>;

bool distorts_much(const hull::SilhouetteView& view) {
    const geometry::PinholeCamera& lens = view.intrinsics;
    if (!lens.has_distortion()) return false;
    for (const double x : {0.0, lens.width - 1.0})
        for (const double y : {0.0, lens.height - 1.0}) {
            const auto undistorted = lens.undistort({x, y});
            if (undistorted && (*undistorted - Eigen::Vector2d(x, y)).norm() > kMuchDistortion_px)
                return true;
        }
    return false;
}

class Trial {
public:
    Trial(std::span<const views::NamedView> views,
          const AgreementOptions& options,
          const std::function<bool()>& go_on)
        : options_(options), go_on_(go_on) {
        for (const views::NamedView& view : views) {
            if (view.view.contours.empty()) continue;  // it abstains anyhow
            names_.push_back(view.name);
            views_.push_back(view.view);
        }
        // the time of a measurement grows with the square of the number of cameras
        const std::size_t most = kRaysPerRig / std::max<std::size_t>(views_.size(), 1);
        options_.rays_per_camera = std::min(options_.rays_per_camera, std::max(most, kLeastRays));
        as_is_ = measure_agreement(views_, options_);
        // the causes below move the site, so its bounds say nothing
        free_options_ = options_;
        free_options_.bounds.reset();
        if (!options_.knows_outside && views_.size() > 3) free_options_.min_seen = 2;
        share_ = as_is_.share();
        strict_share_ = share_of(views_);
    }

    std::optional<Diagnosis> find() {
        if (views_.size() < 2 || as_is_.num_rays() < kMinRays || share_ >= kNearlyAllShare)
            return std::nullopt;
        try_undistorted();
        if (share_ >= kFineShare) return best_;
        try_misreadings();
        try_scales();
        auto flipped = flipped_pictures();  // before the exchanges, which may use up the time
        if (!best_) try_exchanges();
        if (flipped) weigh(std::move(*flipped));
        if (best_ || share_ >= kPoorShare) return best_;
        if (auto one = one_camera()) return one;
        if (auto two = two_cameras()) return two;
        return unknown();
    }

private:
    bool goes_on() const { return !go_on_ || go_on_(); }

    // True if this strict share convinces, compared with that of the rig as it is.
    bool convinces(double share) const {
        const double residual = share_ < kPoorShare ? kResidualShare : kStrictResidualShare;
        return share >= kGoodShare && 1.0 - share <= residual * (1.0 - strict_share_);
    }

    void offer(Cause cause, double share, std::string text, std::vector<std::string> cameras = {}) {
        if (!convinces(share) || (best_ && best_->share_if >= share)) return;
        best_ = Diagnosis{cause, std::move(text), share_, share, std::move(cameras)};
    }

    double share_of(const Views& views) const {
        const Agreement agreement = measure_agreement(views, free_options_);
        return agreement.num_rays() < kMinRays ? 0.0 : agreement.strict_share();
    }

    // Contours come from pictures whose distortion the rig has taken away. Put it back.
    void try_undistorted() {
        if (std::ranges::none_of(views_, distorts_much)) return;
        Views views = views_;
        for (auto& view : views)
            for (auto& contour : view.contours)
                for (Eigen::Vector2d& pixel : contour) pixel = view.intrinsics.distort(pixel);
        offer(Cause::kUndistorted,
              share_of(views),
              "the pictures look undistorted already: give them as the cameras stored them, or "
              "write distortion = [0, 0, 0, 0, 0] and the camera matrix of the undistorted "
              "pictures in the rig");
    }

    void try_misreadings() {
        for (const Misreading misreading : kMisreadings) {
            if (!goes_on()) return;
            Views views = views_;
            for (auto& view : views)
                view.camera_from_site = corrected(view.camera_from_site, misreading);
            offer(misreading == Misreading::kInverted ? Cause::kInverted : Cause::kAxes,
                  share_of(views),
                  explain(misreading));
        }
    }

    // Cameras, those first that contradict the others most.
    std::vector<std::size_t> suspects() const {
        std::vector<std::size_t> order(views_.size());
        for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
        const auto blame = [&](std::size_t i) {
            const CameraAgreement& camera = as_is_.cameras[i];
            return static_cast<double>(camera.contradicted + camera.out_of_view) +
                   100.0 * (1.0 - camera.share());
        };
        std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
            return blame(a) > blame(b);
        });
        if (order.size() > kMaxExchanged) order.resize(kMaxExchanged);
        return order;
    }

    // Cameras keep their names and intrinsics; silhouettes go with the pictures.
    static void exchange(hull::SilhouetteView& a, hull::SilhouetteView& b) {
        std::swap(a.contours, b.contours);
    }

    // The best pair, then a second one: three cameras in a circle, or two pairs.
    void try_exchanges() {
        const std::vector<std::size_t> order = suspects();
        Views current = views_;
        std::vector<std::pair<std::size_t, std::size_t>> pairs;
        double reached = strict_share_;
        for (int round = 0; round < 2; ++round) {
            std::optional<std::pair<std::size_t, std::size_t>> best;
            double best_share = reached;
            for (std::size_t i = 0; i < order.size(); ++i) {
                for (std::size_t k = i + 1; k < order.size() && goes_on(); ++k) {
                    exchange(current[order[i]], current[order[k]]);
                    if (const double share = share_of(current); share > best_share) {
                        best_share = share;
                        best = std::minmax(order[i], order[k]);
                    }
                    exchange(current[order[i]], current[order[k]]);
                }
            }
            if (!best) return;
            exchange(current[best->first], current[best->second]);
            pairs.push_back(*best);
            // a second exchange must do as much as the first
            const bool convinces_more = 1.0 - best_share <= kResidualShare * (1.0 - reached);
            if (convinces(best_share) && (round == 0 || convinces_more))
                return offer(Cause::kSwapped, best_share, text_of(pairs), names_of(pairs));
            reached = best_share;
        }
    }

    std::vector<std::string> names_of(
        const std::vector<std::pair<std::size_t, std::size_t>>& pairs) const {
        std::vector<std::string> names;
        for (const auto& [a, b] : pairs) {
            names.push_back(names_[a]);
            names.push_back(names_[b]);
        }
        return names;
    }

    std::string text_of(const std::vector<std::pair<std::size_t, std::size_t>>& pairs) const {
        std::string text;
        for (const auto& [a, b] : pairs)
            text += fmt::format("{}{} and {}", text.empty() ? "" : ", ", names_[a], names_[b]);
        return fmt::format(
            "{} look swapped: exchange their pictures (folders, serial numbers, "
            "cables), or their entries in the rig",
            text);
    }

    void try_scales() {
        for (const double scale : kScales) {
            for (const bool is_size : {false, true}) {
                if (!goes_on()) return;
                Views views = views_;
                for (auto& view : views) {
                    geometry::PinholeCamera& k = view.intrinsics;
                    k.fx *= scale;
                    k.fy *= scale;
                    if (!is_size) continue;
                    k.cx = (k.cx + 0.5) * scale - 0.5;
                    k.cy = (k.cy + 0.5) * scale - 0.5;
                }
                offer(Cause::kFocal,
                      share_of(views),
                      is_size ? fmt::format("the rig looks calibrated at another picture size: "
                                            "multiply fx, fy, cx and cy by {:.3g}",
                                            scale)
                              : fmt::format("the focal lengths look wrong: multiply fx and fy by "
                                            "{:.3g}, or calibrate again",
                                            scale));
            }
        }
    }

    // Of a camera that hangs upside down, for example: whoever plays its videos turns them.
    // `share_without`: of the others alone, which flipped pictures must hardly lower.
    std::optional<Diagnosis> flipped_pictures(std::size_t camera, double share_without) const {
        std::optional<Diagnosis> best;
        for (const Flip& flip : kFlips) {
            if (!goes_on()) break;
            Views views = views_;
            flip_contours(views[camera], flip);
            const double share = share_of(views);
            if (!convinces(share) || share < share_without - kMostLost ||
                (best && best->share_if >= share))
                continue;
            best = Diagnosis{
                flip.cause, text_of_one(flip, names_[camera]), share_, share, {names_[camera]}};
        }
        return best;
    }

    // A recording program that mirrors, as for a selfie, does so with all cameras.
    std::optional<Diagnosis> flipped_pictures() const {
        if (views_.size() < 3) return std::nullopt;  // two contradict too little
        // three cameras, one of which is off, may seem to be mirrored
        const double least = views_.size() == 3 ? kFineShare : kGoodShare;
        std::optional<Diagnosis> flipped;
        for (const Flip& flip : kFlips) {
            if (!goes_on()) break;
            Views views = views_;
            for (auto& view : views) flip_contours(view, flip);
            const double share = share_of(views);
            if (share >= least && convinces(share) && (!flipped || share > flipped->share_if))
                flipped = Diagnosis{flip.cause, text_of_all(flip), share_, share, {}};
        }
        return flipped;
    }

    // In a symmetric ring flipped pictures of all cameras are the same as cameras that are
    // exchanged with those across a plane of symmetry: one pair is as likely as that, two pairs
    // are not.
    void weigh(Diagnosis flipped) {
        const double lead = flipped.share_if - (best_ ? best_->share_if : 0.0);
        const bool is_swap = best_ && best_->cause == Cause::kSwapped && lead >= -kAlike;
        if (!best_ || lead > kAlike || (is_swap && best_->cameras.size() > 2))
            best_ = std::move(flipped);
        else if (is_swap)
            best_->text += "; if they are not, " + flipped.text;
    }

    std::optional<Diagnosis> one_camera() const {
        if (views_.size() < 4) return std::nullopt;
        double best_share = 0.0;
        std::size_t best = 0;
        for (std::size_t i = 0; i < views_.size() && goes_on(); ++i) {
            Views views = views_;
            views.erase(views.begin() + static_cast<std::ptrdiff_t>(i));
            const double share = share_of(views);
            if (share > best_share) {
                best_share = share;
                best = i;
            }
        }
        if (!convinces(best_share)) return std::nullopt;
        if (auto flipped = flipped_pictures(best, best_share)) return flipped;
        return Diagnosis{
            Cause::kOneCamera,
            fmt::format(
                "{} contradicts all others: it was moved since the calibration, "
                "its entry in the rig is wrong, its pictures are of another instant, or its "
                "silhouettes are wrong; look at them with --preview; to go on without it, delete "
                "its [[camera]] in rig.toml",
                names_[best]),
            share_,
            best_share,
            {names_[best]}};
    }

    // The others must agree without these two, and without no other pair nearly as well.
    std::optional<Diagnosis> two_cameras() const {
        if (views_.size() < kLeastForTwo) return std::nullopt;
        const std::vector<std::size_t> order = suspects();
        double best_share = 0.0, second_share = 0.0;
        std::pair<std::size_t, std::size_t> best;
        for (std::size_t i = 0; i < order.size(); ++i) {
            for (std::size_t k = i + 1; k < order.size(); ++k) {
                if (!goes_on()) return std::nullopt;
                const auto pair = std::minmax(order[i], order[k]);
                Views views = views_;
                views.erase(views.begin() + static_cast<std::ptrdiff_t>(pair.second));
                views.erase(views.begin() + static_cast<std::ptrdiff_t>(pair.first));
                const double share = share_of(views);
                second_share = std::max(second_share, std::min(share, best_share));
                if (share <= best_share) continue;
                best_share = share;
                best = pair;
            }
        }
        if (!convinces(best_share) || 1.0 - best_share > kResidualShare * (1.0 - second_share))
            return std::nullopt;
        return Diagnosis{
            Cause::kTwoCameras,
            fmt::format("{0} and {1} contradict all others, which agree: they were moved since the "
                        "calibration, their entries in the rig are older or wrong, their pictures "
                        "are of another instant, or their silhouettes are wrong; look at them with "
                        "--preview; to go on without them, delete their [[camera]] in rig.toml",
                        names_[best.first],
                        names_[best.second]),
            share_,
            best_share,
            {names_[best.first], names_[best.second]}};
    }

    Diagnosis unknown() const {
        const std::size_t worst = as_is_.worst();
        if (options_.is_room_learned) {
            return {Cause::kUnknown,
                    fmt::format(
                        "the cameras contradict each other, {} most: the empty room was learned "
                        "from pictures with people in it, so somebody who stayed at one place all "
                        "the time, or turned on the spot, is part of it: look at the silhouettes "
                        "with --preview; if parts of people are missing, give masks of another "
                        "tool (calibrate import --masks), or film the empty room, or people who "
                        "walk away from where they stood (docs/backgrounds.md); if the "
                        "silhouettes are right, calibrate again",
                        names_[worst]),
                    share_,
                    share_,
                    {names_[worst]}};
        }
        return {
            Cause::kUnknown,
            fmt::format("the cameras contradict each other, {} most: look at the silhouettes "
                        "with --preview; if they are right, do all cameras or videos show the same "
                        "instant? Else calibrate again; if parts of people are "
                        "missing, film the empty room without people (docs/backgrounds.md)",
                        names_[worst]),
            share_,
            share_,
            {names_[worst]}};
    }

    AgreementOptions options_;
    AgreementOptions free_options_;
    const std::function<bool()>& go_on_;
    std::vector<std::string> names_;
    Views views_;
    Agreement as_is_;
    double share_ = 1.0;
    double strict_share_ = 1.0;  // without bounds
    std::optional<Diagnosis> best_;
};

}  // namespace

bool distort_much(std::span<const views::NamedView> views) {
    return std::ranges::any_of(
        views, [](const views::NamedView& view) { return distorts_much(view.view); });
}

std::optional<Diagnosis> diagnose(std::span<const views::NamedView> views,
                                  const AgreementOptions& options,
                                  const std::function<bool()>& go_on) {
    return Trial(views, options, go_on).find();
}

}  // namespace atrium::rig_check
