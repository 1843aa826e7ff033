// Pictures of the empty room.
#include "tools/calibrate/recording/gatherer.hpp"
#include "tools/calibrate/recording/mask_checks.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace atrium::calibrate {
namespace {

// Fewest pictures with people in them from which a site learns the empty room: as
// site_node/occupied_room/learn_occupied_room.hpp.
constexpr std::size_t kFewestToLearnFrom = 8;

}  // namespace

Expected<void> Gatherer::gather_backgrounds() {
    if (!folders_.background.empty()) {
        auto named = find_shots(folders_.background);
        if (!named) return tl::unexpected(named.error());
        rooms_ = std::move(*named);
        if (std::ranges::any_of(rooms_, &Shots::is_background))
            std::erase_if(rooms_, [](const Shots& shots) { return !shots.is_background; });
    }
    auto matches = match_shots(with_frames_, rooms_, names_);
    if (!matches) return make_error(matches.error().kind, "background: " + matches.error().message);
    material_.backgrounds = std::move(matches->by_camera);
    if (!material_.masks.empty()) return {};
    if (auto fitting = check_background_sizes(material_); !fitting) return fitting;
    if (matches->missing.empty()) {
        tell("background: the empty room was found for every camera");
    } else {
        report_backgrounds(matches->missing);
    }
    return {};
}

void Gatherer::report_backgrounds(const std::vector<std::string>& without) {
    const std::string cure =
        "film the empty room with the same cameras and give its folder with --background, or give "
        "masks of the people with --masks";
    // a video's number of pictures may be unknown
    if (fewest_ > 0 && fewest_ < kFewestToLearnFrom) {
        problem(
            fmt::format("background: no empty room of {}, and {} per camera is too few to "
                        "learn it from ({}): site_node will end with an error; {}",
                        known(without),
                        counted(fewest_, "picture"),
                        kFewestToLearnFrom,
                        cure));
        return;
    }
    check(
        fmt::format("background: no empty room of {}: the site learns it from the pictures with "
                    "people, which works where people move; for better outlines {}",
                    known(without),
                    cure));
}

}  // namespace atrium::calibrate
