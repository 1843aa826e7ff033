#include "site_node/rig_check/agreement.hpp"

#include "site_node/rig_check/agreeing_depths.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace atrium::rig_check {
namespace {

constexpr std::size_t kRows = 96;      // of the search for pixels of a silhouette
constexpr double kNearBounds_m = 0.3;  // farther away somebody else stands outside
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Span {
    double y = 0.0;
    double left = 0.0;
    double right = 0.0;
};

// The parts of kRows rows inside the contours, by the even-odd rule.
std::vector<Span> spans_of(const std::vector<std::vector<Eigen::Vector2d>>& contours) {
    double low = kInfinity;
    double high = -kInfinity;
    for (const auto& contour : contours) {
        for (const Eigen::Vector2d& p : contour) {
            low = std::min(low, p.y());
            high = std::max(high, p.y());
        }
    }
    std::vector<Span> spans;
    std::vector<double> xs;
    for (std::size_t row = 0; row < kRows && low < high; ++row) {
        const double y = low + (high - low) * (static_cast<double>(row) + 0.5) / kRows;
        xs.clear();
        for (const auto& contour : contours) {
            for (std::size_t i = 0, j = contour.size() - 1; i < contour.size(); j = i++) {
                const Eigen::Vector2d& a = contour[j];
                const Eigen::Vector2d& b = contour[i];
                if ((a.y() > y) != (b.y() > y))
                    xs.push_back(a.x() + (y - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
            }
        }
        std::sort(xs.begin(), xs.end());
        for (std::size_t i = 0; i + 1 < xs.size(); i += 2) spans.push_back({y, xs[i], xs[i + 1]});
    }
    return spans;
}

// About `count` pixels, spread evenly over the inside.
std::vector<Eigen::Vector2d> pixels_inside(
    const std::vector<std::vector<Eigen::Vector2d>>& contours, std::size_t count) {
    const std::vector<Span> spans = spans_of(contours);
    double length = 0.0;
    for (const Span& span : spans) length += span.right - span.left;
    std::vector<Eigen::Vector2d> pixels;
    if (!(length > 0.0)) return pixels;
    const double step = length / static_cast<double>(count);
    double next = 0.5 * step;  // from the left end of the current span
    for (const Span& span : spans) {
        for (; next < span.right - span.left; next += step)
            pixels.emplace_back(span.left + next, span.y);
        next -= span.right - span.left;
    }
    return pixels;
}

// Depths at which a ray is inside the box; empty if begin > end.
DepthInterval inside_box(const geometry::Aabb& box,
                         const Eigen::Vector3d& centre,
                         const Eigen::Vector3d& direction) {
    DepthInterval inside{0.0, kInfinity};
    for (int axis = 0; axis < 3; ++axis) {
        double near = (box.min[axis] - centre[axis]) / direction[axis];
        double far = (box.max[axis] - centre[axis]) / direction[axis];
        if (near > far) std::swap(near, far);
        inside.begin = std::max(inside.begin, near);
        inside.end = std::min(inside.end, far);
    }
    return inside;
}

// Something that begins or ends at a depth of the ray.
struct Event {
    double depth;
    std::size_t camera;
    bool begins;
    bool is_seen;  // of Projector's `seen`, else of `agreeing`
};

struct Candidate {
    DepthInterval depths;
    std::size_t num_agreeing = 0;
    std::uint64_t agreeing = 0;  // bit per view
};

class Measurement {
public:
    Measurement(const std::vector<const hull::SilhouetteView*>& views,
                const AgreementOptions& options)
        : options_(options) {
        result_.cameras.resize(views.size());
        for (const hull::SilhouetteView* view : views)
            projectors_.emplace_back(*view, options.knows_outside);
        for (std::size_t i = 0; i < views.size(); ++i) {
            if (!views[i]->contours.empty()) voters_.push_back(i);
        }
        if (voters_.size() < 2) return;
        for (const std::size_t i : voters_) {
            for (const Eigen::Vector2d& pixel :
                 pixels_inside(views[i]->contours, options.rays_per_camera)) {
                follow(i, projectors_[i].centre_site(), projectors_[i].direction_site(pixel));
            }
        }
    }

    Agreement result() && { return std::move(result_); }

private:
    void collect(std::size_t own, const Eigen::Vector3d& centre, const Eigen::Vector3d& direction) {
        events_.clear();
        for (const std::size_t k : voters_) {
            if (k == own) continue;
            projectors_[k].find(centre, direction, seen_, agreeing_);
            for (const DepthInterval& part : agreeing_) add(part, k, false);
            if (options_.knows_outside) continue;
            for (const DepthInterval& part : seen_) add(part, k, true);
        }
        std::sort(events_.begin(), events_.end(), [](const Event& a, const Event& b) {
            return a.depth < b.depth;
        });
    }

    void add(const DepthInterval& part, std::size_t camera, bool is_seen) {
        events_.push_back({part.begin, camera, true, is_seen});
        if (part.end < kInfinity) events_.push_back({part.end, camera, false, is_seen});
    }

    // Visits every part of the ray between two events with the cameras that agree there.
    template <typename Visit>
    void sweep(const Visit& visit) const {
        std::uint64_t agreeing = 0;
        std::size_t num_agreeing = 0;
        std::size_t num_seen = 0;
        const std::size_t min_seen = options_.knows_outside ? 0 : options_.min_seen;
        for (std::size_t e = 0; e < events_.size(); ++e) {
            const Event& event = events_[e];
            std::size_t& count = event.is_seen ? num_seen : num_agreeing;
            count += event.begins ? 1 : static_cast<std::size_t>(-1);
            if (!event.is_seen) agreeing ^= std::uint64_t{1} << event.camera;
            const double end = e + 1 < events_.size() ? events_[e + 1].depth : kInfinity;
            if (end > event.depth && num_seen >= min_seen && num_agreeing > 0)
                visit(Candidate{{event.depth, end}, num_agreeing, agreeing});
        }
    }

    void follow(std::size_t own, const Eigen::Vector3d& centre, const Eigen::Vector3d& direction) {
        collect(own, centre, direction);
        const DepthInterval box = options_.bounds ? inside_box(*options_.bounds, centre, direction)
                                                  : DepthInterval{0.0, kInfinity};
        const std::size_t all = voters_.size() - 1;
        Candidate best;
        bool is_explained = false;
        std::optional<Eigen::Vector3d> outside;  // the point nearest to the bounds
        sweep([&](const Candidate& candidate) {
            const DepthInterval within{std::max(candidate.depths.begin, box.begin),
                                       std::min(candidate.depths.end, box.end)};
            if (within.begin < within.end) {
                is_explained |= candidate.num_agreeing == all;
                if (candidate.num_agreeing > best.num_agreeing) best = candidate;
            } else if (candidate.num_agreeing == all && options_.bounds) {
                note_outside(candidate.depths, box, centre, direction, outside);
            }
        });
        CameraAgreement& mine = result_.cameras[own];
        const bool meets_box = box.begin < box.end;
        if (!is_explained && !outside && !meets_box) return;
        if (!is_explained && outside && !count_cut(*outside, mine)) return;
        ++mine.rays;
        if (is_explained) {
            ++mine.explained;
        } else if (!outside && 2 * best.num_agreeing >= all && best.num_agreeing > 0) {
            if (blame(own, best, centre, direction)) ++mine.beyond;
        }
    }

    void note_outside(const DepthInterval& depths,
                      const DepthInterval& box,
                      const Eigen::Vector3d& centre,
                      const Eigen::Vector3d& direction,
                      std::optional<Eigen::Vector3d>& outside) const {
        const double middle = box.begin < box.end && box.end < kInfinity
                                  ? 0.5 * (box.begin + box.end)
                                  : nearest_to_box(centre, direction);
        const double end = std::min(depths.end, 1e6 * (1.0 + depths.begin));
        const Eigen::Vector3d p = centre + std::clamp(middle, depths.begin, end) * direction;
        if (!outside || distance_to_box(p) < distance_to_box(*outside)) outside = p;
    }

    double nearest_to_box(const Eigen::Vector3d& centre, const Eigen::Vector3d& direction) const {
        return std::max(
            0.0, (options_.bounds->centre() - centre).dot(direction) / direction.squaredNorm());
    }

    Eigen::Vector3d beyond_box(const Eigen::Vector3d& p) const {
        return p - p.cwiseMax(options_.bounds->min).cwiseMin(options_.bounds->max);
    }
    double distance_to_box(const Eigen::Vector3d& p) const { return beyond_box(p).norm(); }

    // False if the point is so far outside that it belongs to somebody else.
    bool count_cut(const Eigen::Vector3d& p, CameraAgreement& camera) {
        const Eigen::Vector3d beyond = beyond_box(p);
        if (beyond.norm() > kNearBounds_m) return false;
        ++camera.cut;
        int axis = 0;
        beyond.cwiseAbs().maxCoeff(&axis);
        const bool is_above = beyond[axis] > 0.0;
        const auto face = static_cast<std::size_t>(2 * axis + (is_above ? 1 : 0));
        double& farthest = result_.farthest_cut_m[face];
        const bool is_first = result_.cut_by_face[face]++ == 0;
        farthest = is_first   ? p[axis]
                   : is_above ? std::max(farthest, p[axis])
                              : std::min(farthest, p[axis]);
        return true;
    }

    // Counts the few cameras that contradict what most cameras confirm. True if their pictures just
    // do not show it.
    bool blame(std::size_t own,
               const Candidate& best,
               const Eigen::Vector3d& centre,
               const Eigen::Vector3d& direction) {
        const double depth = best.depths.end < kInfinity
                                 ? 0.5 * (best.depths.begin + best.depths.end)
                                 : 1.5 * best.depths.begin;
        const Eigen::Vector3d p = centre + depth * direction;
        bool is_beyond = true;
        for (const std::size_t k : voters_) {
            if (k == own || (best.agreeing >> k & 1) != 0) continue;
            CameraAgreement& camera = result_.cameras[k];
            const bool is_in_picture = projectors_[k].is_in_picture(p);
            ++(is_in_picture ? camera.contradicted : camera.out_of_view);
            is_beyond &= !is_in_picture;
        }
        return is_beyond;
    }

    const AgreementOptions& options_;
    std::vector<Projector> projectors_;
    std::vector<std::size_t> voters_;  // views with contours
    Agreement result_;
    std::vector<Event> events_;
    std::vector<DepthInterval> seen_;
    std::vector<DepthInterval> agreeing_;
};

}  // namespace

std::size_t Agreement::num_rays() const {
    std::size_t sum = 0;
    for (const CameraAgreement& camera : cameras) sum += camera.rays;
    return sum;
}

double Agreement::share() const {
    std::size_t explained = 0;
    std::size_t counted = 0;
    for (const CameraAgreement& camera : cameras) {
        explained += camera.explained;
        counted += camera.rays - camera.cut - camera.beyond;
    }
    return counted == 0 ? 1.0 : static_cast<double>(explained) / static_cast<double>(counted);
}

double Agreement::strict_share() const {
    std::size_t explained = 0;
    for (const CameraAgreement& camera : cameras) explained += camera.explained;
    const std::size_t all = num_rays();
    return all == 0 ? 1.0 : static_cast<double>(explained) / static_cast<double>(all);
}

std::size_t Agreement::worst() const {
    const auto worst = std::min_element(
        cameras.begin(), cameras.end(), [](const CameraAgreement& a, const CameraAgreement& b) {
            return a.share() < b.share();
        });
    return worst == cameras.end() ? 0 : static_cast<std::size_t>(worst - cameras.begin());
}

Agreement measure_agreement(std::span<const hull::SilhouetteView> views,
                            const AgreementOptions& options) {
    std::vector<const hull::SilhouetteView*> pointers;
    for (const hull::SilhouetteView& view : views) pointers.push_back(&view);
    return Measurement(pointers, options).result();
}

Agreement measure_agreement(std::span<const views::NamedView> views,
                            const AgreementOptions& options) {
    std::vector<const hull::SilhouetteView*> pointers;
    for (const views::NamedView& view : views) pointers.push_back(&view.view);
    return Measurement(pointers, options).result();
}

}  // namespace atrium::rig_check
