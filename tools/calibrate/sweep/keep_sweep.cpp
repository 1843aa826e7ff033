#include "tools/calibrate/sweep/keep_sweep.hpp"

#include "core/base/write_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <system_error>
#include <utility>

namespace atrium::calibrate {
namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t kPointsBytes = 16U << 20;

// "--size 1280x1024" if all pictures have this size, else what to give.
std::string size_option(const std::vector<NominalCamera>& cameras) {
    const NominalCamera& first = cameras.front();
    const bool is_one = std::ranges::all_of(cameras, [&](const NominalCamera& camera) {
        return camera.width == first.width && camera.height == first.height;
    });
    return is_one ? fmt::format("--size {}x{}", first.width, first.height)
                  : std::string("--like RIG with their sizes");
}

}  // namespace

fs::path points_file(const SweepOptions& options, const fs::path& rig) {
    if (!options.keep_points.empty()) return options.keep_points;
    fs::path file = rig;
    return file.replace_extension(".points.csv");
}

Expected<Sweep> keep_sweep(SweepOptions& options,
                           const Wand& wand,
                           const fs::path& file,
                           bool may_replace,
                           std::stop_token stop) {
    if (auto resolved = options.source.resolve(); !resolved)
        return tl::unexpected(resolved.error());
    std::error_code failure;
    if (!may_replace && !options.keep_points.empty() && fs::exists(file, failure))
        return make_error(ErrorKind::kConfiguration,
                          fmt::format("{}: exists already; give another --keep-points, or --force "
                                      "to replace it",
                                      file.string()));
    // before somebody sweeps in vain
    if (auto fits =
            check_folder_writable(fs::absolute(file).parent_path(), kPointsBytes, "--keep-points");
        !fits)
        return tl::unexpected(fits.error());
    auto sweep = record_sweep(options, wand, std::move(stop));
    if (!sweep) return sweep;
    if (auto kept = save_light_points(sweep->points, file); !kept)
        return tl::unexpected(kept.error());
    fmt::print("wrote {}: to solve it again without a sweep, give --points {} {}\n",
               file.string(),
               file.string(),
               size_option(sweep->cameras));
    std::fflush(stdout);
    return sweep;
}

}  // namespace atrium::calibrate
