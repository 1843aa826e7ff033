#include "viewer/run_limit.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace atrium::viewer {
namespace {

RunLimit::Clock::duration duration_of(double s) {
    return std::chrono::duration_cast<RunLimit::Clock::duration>(std::chrono::duration<double>(s));
}

}  // namespace

RunLimit::RunLimit(const ViewerConfig& config, Clock::time_point begin)
    : wait_people_(config.wait_people),
      wait_timeout_(duration_of(config.wait_timeout_s)),
      frames_(config.frames),
      length_(duration_of(config.seconds)),
      since_(begin),
      is_counting_(config.wait_people == 0) {}

Expected<RunLimit::Now> RunLimit::update(std::uint64_t num_frames,
                                         std::size_t num_people,
                                         Clock::time_point now) {
    bool began = false;
    if (!is_counting_ && num_people >= wait_people_) {
        is_counting_ = began = true;
        since_ = now;
        counted_from_ = num_frames;
    }
    if (!is_counting_) {
        if (now - since_ <= wait_timeout_) return Now::kGoesOn;
        return make_error(ErrorKind::kUnavailable,
                          fmt::format("only {} of {} people came within {} s",
                                      num_people,
                                      wait_people_,
                                      std::chrono::duration<double>(wait_timeout_).count()));
    }
    const std::uint64_t num_counted = num_frames - counted_from_;
    const Clock::duration passed = now - since_;
    if (passed.count() > 0)
        frames_per_s_ =
            static_cast<double>(num_counted) / std::chrono::duration<double>(passed).count();
    if (frames_ > 0 && num_counted >= frames_) return Now::kOver;
    if (length_.count() > 0 && passed >= length_) return Now::kOver;
    return began ? Now::kBegan : Now::kGoesOn;
}

std::string RunLimit::cure(const std::string& place, const std::vector<std::string>& silent_sites) {
    if (!silent_sites.empty()) {
        return fmt::format(
            "; this viewer is in {}, where {} {} and {} nothing yet: a site without pictures of "
            "the empty room learns it before it publishes; wait longer with --wait_timeout_s, or "
            "look at what the site reports",
            place,
            fmt::join(silent_sites, ", "),
            silent_sites.size() == 1 ? "is a site" : "are sites",
            silent_sites.size() == 1 ? "publishes" : "publish");
    }
    return fmt::format(
        "; this viewer is in {}: look whether the sites run, what they report, and "
        "whether they are in the same world, domain and network, and have keys of the same "
        "world, or none",
        place);
}

}  // namespace atrium::viewer
