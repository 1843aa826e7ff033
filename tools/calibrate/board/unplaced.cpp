#include "tools/calibrate/board/unplaced.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::calibrate {
namespace {

class Explainer {
public:
    Explainer(const Bundle& bundle,
              const std::vector<BoardView>& views,
              const std::vector<CameraPair>& pairs,
              const std::vector<std::uint32_t>& instants)
        : bundle_(bundle), views_(views), pairs_(pairs), instants_(instants) {}

    std::string run() const {
        std::string text;
        for (std::size_t c = 0; c < bundle_.cameras.size(); ++c) {
            if (bundle_.cameras[c].is_placed && !is_alone(c)) continue;
            if (!text.empty()) text += "; ";
            text += explain(c);
            // of two cameras, both have the same cause
            if (bundle_.cameras.size() == 2) break;
        }
        return text;
    }

private:
    // Placed only because the rig has to begin somewhere.
    bool is_alone(std::size_t camera) const {
        return bundle_.cameras.size() > 1 &&
               std::ranges::none_of(bundle_.cameras, [&](const BundleCamera& other) {
                   return other.is_placed && &other != &bundle_.cameras[camera];
               });
    }

    std::string explain(std::size_t c) const {
        const std::string& name = bundle_.cameras[c].name;
        std::size_t num_shared = 0, num_agreeing = 0, num_tried = 0;
        std::string best;
        std::size_t most = 0;
        for (const CameraPair& pair : pairs_) {
            if (pair.a != c && pair.b != c) continue;
            num_shared += pair.num_shared;
            num_agreeing += pair.num_agreeing;
            num_tried += pair.num_tried;
            if (pair.num_shared > most) {
                most = pair.num_shared;
                best = bundle_.cameras[pair.a == c ? pair.b : pair.a].name;
            }
        }
        const auto num_views =
            std::ranges::count(views_, static_cast<std::uint32_t>(c), &BoardView::camera);
        const auto usable = std::ranges::find_if(pairs_, [&](const CameraPair& pair) {
            return (pair.a == c || pair.b == c) && pair.is_usable();
        });
        if (usable != pairs_.end())  // a group of its own
            return fmt::format(
                "camera '{}' shows the board together with '{}', but in less than {} "
                "pictures with one of the cameras that have a place; hold it where "
                "one of each sees it, at 10 places or more",
                name,
                bundle_.cameras[usable->a == c ? usable->b : usable->a].name,
                kLeastAgreeing);
        if (num_shared == 0)
            return fmt::format(
                "camera '{}' never shows the board together with another camera: "
                "its {} pictures with the board are of other instants; hold the "
                "board still where '{}' and another camera see it, at 10 places or "
                "more",
                name,
                num_views,
                name);
        if (most < kLeastAgreeing)
            return fmt::format(
                "camera '{}' shows the board together with others in {} pictures "
                "only; hold it where both see it, at 10 places or more",
                name,
                most);
        if (const int late = find_lateness(bundle_, views_, c, instants_); late != 0)
            return fmt::format(
                "camera '{}' is {} by {} instant{}: its pictures fit those of the "
                "others then; check its trigger, or shift the numbers of its "
                "pictures by {}",
                name,
                late > 0 ? "late" : "early",
                std::abs(late),
                std::abs(late) == 1 ? "" : "s",
                -late);
        if (is_mirrored(c))
            return fmt::format(
                "the pictures of camera '{}' are mirrored: turn mirroring off in "
                "its settings, and record again",
                name);
        return fmt::format(
            "camera '{}' contradicts the others: of {} boards that it shows together with '{}' or "
            "others, {} agree; its pictures are of other instants, of another camera, or it was "
            "moved",
            name,
            num_tried,
            best,
            num_agreeing);
    }

    // Only a chessboard is found in mirrored pictures, with its columns or rows swapped: as if the
    // camera saw a mirrored room.
    bool is_mirrored(std::size_t camera) const {
        for (const int axis : {0, 1}) {
            Bundle mirrored = bundle_;
            BundleCamera& seen_by = mirrored.cameras[camera];
            seen_by.lens[1] = seen_by.width - 1 - seen_by.lens[1];
            seen_by.lens[6] *= -1.0;  // p2 acts along x
            std::vector<BoardView> views = views_;
            for (BoardView& view : views) {
                if (view.camera != camera) continue;
                for (std::size_t s = view.begin; s < view.end; ++s) {
                    Sighting& sighting = mirrored.sightings[s];
                    sighting.px.x() = seen_by.width - 1 - sighting.px.x();
                    sighting.light = mirrored_light(sighting.light, axis);
                }
                view.places = find_places(mirrored, view);
            }
            if (std::ranges::any_of(pairs_of(mirrored, views, camera), &CameraPair::is_usable))
                return true;
        }
        return false;
    }

    std::uint32_t mirrored_light(std::uint32_t light, int axis) const {
        const auto& lights = bundle_.wand.lights_m;
        Eigen::Vector3d place = lights[light];
        place[axis] = lights.front()[axis] + lights.back()[axis] - place[axis];
        const auto nearest = std::ranges::min_element(
            lights, {}, [&](const Eigen::Vector3d& l) { return (l - place).squaredNorm(); });
        return static_cast<std::uint32_t>(nearest - lights.begin());
    }

    const Bundle& bundle_;
    const std::vector<BoardView>& views_;
    const std::vector<CameraPair>& pairs_;
    const std::vector<std::uint32_t>& instants_;
};

}  // namespace

std::string explain_unplaced(const Bundle& bundle,
                             const std::vector<BoardView>& views,
                             const std::vector<CameraPair>& pairs,
                             const std::vector<std::uint32_t>& instants) {
    return Explainer(bundle, views, pairs, instants).run();
}

}  // namespace atrium::calibrate
