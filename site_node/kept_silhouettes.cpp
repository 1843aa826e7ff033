#include "site_node/kept_silhouettes.hpp"

#include "site_node/views/views_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <system_error>
#include <utility>

namespace atrium::site_node {
namespace {

namespace fs = std::filesystem;

tl::unexpected<Error> not_written(const fs::path& path, const std::string& reason) {
    return make_error(ErrorKind::kUnavailable, fmt::format("{}: {}", path.string(), reason));
}

// A folder that an earlier writing made, or none.
bool has_silhouettes_only(const fs::path& folder) {
    std::error_code problem;
    for (fs::directory_iterator it(folder, problem), end; !problem && it != end;
         it.increment(problem)) {
        const std::string stem = it->path().stem().string();
        const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
        if (it->path().extension() != ".json" || !std::ranges::all_of(stem, is_digit)) return false;
    }
    return true;
}

}  // namespace

KeptSilhouettes::KeptSilhouettes(fs::path folder, std::size_t most_instants)
    : folder_(std::move(folder)), most_instants_(most_instants) {}

void KeptSilhouettes::add(Instant instant) {
    if (!has_folder()) return;
    instants_.push_back(std::move(instant));
    if (instants_.size() > most_instants_) instants_.pop_front();
}

Expected<void> KeptSilhouettes::write() const {
    const fs::path current = folder_ / "views";
    const fs::path fresh = folder_ / "views.new";
    const fs::path old = folder_ / "views.old";
    std::error_code problem;
    for (const fs::path& path : {current, fresh, old})
        if (!has_silhouettes_only(path))
            return not_written(path, "has other files than silhouettes of a site; move them away");
    fs::remove_all(fresh, problem);
    fs::create_directories(fresh, problem);
    if (problem) return not_written(fresh, "cannot create: " + problem.message());
    const auto save = [&](const std::vector<views::NamedView>& seen, std::uint64_t frame_id) {
        return views::save_views_file(seen, fresh / fmt::format("{:06d}.json", frame_id));
    };
    for (const Instant& instant : instants_) {
        if (!instant.before.empty())
            if (auto saved = save(instant.before, instant.frame_id - 1); !saved) return saved;
        if (auto saved = save(instant.now, instant.frame_id); !saved) return saved;
    }
    fs::remove_all(old, problem);
    fs::rename(current, old, problem);  // there may be none
    fs::rename(fresh, current, problem);
    if (problem) return not_written(current, "cannot replace: " + problem.message());
    fs::remove_all(old, problem);
    return {};
}

}  // namespace atrium::site_node
