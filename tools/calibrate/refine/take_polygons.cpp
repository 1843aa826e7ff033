#include "tools/calibrate/refine/take_polygons.hpp"

#include "site_node/views/views_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <map>
#include <system_error>
#include <utility>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

constexpr double kSameLens_px = 0.01;

Expected<std::map<std::uint64_t, fs::path>> numbered_files(const fs::path& folder) {
    std::map<std::uint64_t, fs::path> files;
    std::error_code problem;
    for (fs::directory_iterator it(folder, problem), end; !problem && it != end;
         it.increment(problem)) {
        const std::string stem = it->path().stem().string();
        std::uint64_t number = 0;
        const auto [rest, wrong] = std::from_chars(stem.data(), stem.data() + stem.size(), number);
        if (it->path().extension() == ".json" && wrong == std::errc() &&
            rest == stem.data() + stem.size())
            files[number] = it->path();
    }
    if (problem)
        return make_error(
            ErrorKind::kNotFound,
            fmt::format("{}: cannot be read: {}", folder.string(), problem.message()));
    if (files.empty())
        return make_error(ErrorKind::kInvalidData,
                          fmt::format("{}: has no files such as 000001.json, as a site writes them",
                                      folder.string()));
    return files;
}

// Polygons are undistorted, so only the pinhole part of the lens shows.
bool is_same_lens(const geometry::PinholeCamera& a, const geometry::PinholeCamera& b) {
    const auto differ = [](double x, double y) { return std::abs(x - y) > kSameLens_px; };
    return a.width == b.width && a.height == b.height && !differ(a.fx, b.fx) &&
           !differ(a.fy, b.fy) && !differ(a.cx, b.cx) && !differ(a.cy, b.cy) &&
           !differ(a.skew, b.skew);
}

class PolygonReader {
public:
    explicit PolygonReader(std::span<const geometry::CalibratedCamera> rig)
        : rig_(rig), has_seen_(rig.size()) {}

    // The views of the rig's cameras, in its order.
    Expected<std::vector<views::NamedView>> read(const fs::path& file) {
        auto all = views::load_views_file(file);
        if (!all) return all;
        std::vector<views::NamedView> seen;
        for (std::size_t c = 0; c < rig_.size(); ++c) {
            const auto view = std::ranges::find(*all, rig_[c].name, &views::NamedView::name);
            if (view == all->end()) continue;
            if (!is_same_lens(view->view.intrinsics, rig_[c].intrinsics))
                return make_error(
                    ErrorKind::kConfiguration,
                    fmt::format("{}: has silhouettes of '{}' through another lens ({}x{} px, f "
                                "{:.1f} px) than the rig's ({}x{} px, f {:.1f} px): give the rig "
                                "that the site had, or a recording",
                                file.string(),
                                rig_[c].name,
                                view->view.intrinsics.width,
                                view->view.intrinsics.height,
                                view->view.intrinsics.fx,
                                rig_[c].intrinsics.width,
                                rig_[c].intrinsics.height,
                                rig_[c].intrinsics.fx));
            view->view.camera_from_site = rig_[c].camera_from_site;
            has_seen_[c] = 1;
            seen.push_back(std::move(*view));
        }
        return seen;
    }

    std::vector<coherence::SilhouetteHull> hulls_of(const std::vector<views::NamedView>& seen) {
        std::vector<coherence::SilhouetteHull> hulls(rig_.size());
        for (const views::NamedView& view : seen) {
            const auto camera =
                std::ranges::find(rig_, view.name, &geometry::CalibratedCamera::name);
            auto& hull = hulls[static_cast<std::size_t>(camera - rig_.begin())];
            hull = coherence::hull_of(view.view.contours, camera->intrinsics);
        }
        return hulls;
    }

    // The first camera that no file has; empty: none.
    std::string missing() const {
        const auto camera = std::ranges::find(has_seen_, 0);
        return camera == has_seen_.end()
                   ? std::string()
                   : rig_[static_cast<std::size_t>(camera - has_seen_.begin())].name;
    }

private:
    std::span<const geometry::CalibratedCamera> rig_;
    std::vector<std::uint8_t> has_seen_;
};

}  // namespace

bool has_polygons(const fs::path& folder) {
    std::error_code problem;
    return fs::is_directory(folder / "views", problem) && !fs::exists(folder / "rig.toml", problem);
}

Expected<Take> read_polygons(const fs::path& folder,
                             std::span<const geometry::CalibratedCamera> rig,
                             const TakeOptions& options) {
    const auto files = numbered_files(folder / "views");
    if (!files) return tl::unexpected(files.error());
    std::vector<std::uint64_t> choices;
    for (const auto& [number, file] : *files)
        if (number > 0 && files->contains(number - 1)) choices.push_back(number);
    if (choices.empty())
        for (const auto& [number, file] : *files) choices.push_back(number);
    PolygonReader reader(rig);
    Take take;
    take.num_instants = files->size();
    const std::size_t count = std::min(options.most_sights, choices.size());
    for (std::size_t i = 0; i < count; ++i) {
        if (options.report) options.report(fmt::format("reading instant {} of {}", i + 1, count));
        const std::uint64_t number = choices[i * choices.size() / count];
        auto now = reader.read(files->at(number));
        if (!now) return tl::unexpected(now.error());
        coherence::Sight& sight = take.sights.emplace_back();
        sight.now = reader.hulls_of(*now);
        take.views.push_back(std::move(*now));
        if (number == 0 || !files->contains(number - 1)) continue;
        const auto before = reader.read(files->at(number - 1));
        if (!before) return tl::unexpected(before.error());
        sight.before = reader.hulls_of(*before);
    }
    if (const std::string camera = reader.missing(); !camera.empty())
        return make_error(
            ErrorKind::kConfiguration,
            fmt::format("{}: has no silhouettes of camera '{}', which the rig names: give the rig "
                        "of the site that wrote them",
                        folder.string(),
                        camera));
    return take;
}

}  // namespace atrium::calibrate
