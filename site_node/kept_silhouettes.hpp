#pragma once

#include "core/base/expected.hpp"
#include "site_node/views/named_view.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <vector>

namespace atrium::site_node {

/// The newest silhouettes by which a rig is judged, and the folder that gets them when they show
/// that it is no longer true. `calibrate check` and `refine` read it. Not thread-safe.
class KeptSilhouettes {
public:
    /// Two metaframes in a row, of the cameras that delivered.
    struct Instant {
        std::uint64_t frame_id = 0;
        std::vector<views::NamedView> now;
        std::vector<views::NamedView> before;  // of frame_id - 1; empty: unknown
    };

    /// Keeps `most_instants`. An empty `folder` keeps nothing.
    KeptSilhouettes(std::filesystem::path folder, std::size_t most_instants);

    bool has_folder() const { return !folder_.empty(); }
    const std::filesystem::path& folder() const { return folder_; }

    void add(Instant instant);

    /// Replaces `views/` in the folder, at once, by one file per metaframe
    /// (views::save_views_file). Error kUnavailable; `views/` is then as it was. Never replaces a
    /// folder with other files.
    Expected<void> write() const;

private:
    std::filesystem::path folder_;
    std::size_t most_instants_;
    std::deque<Instant> instants_;
};

}  // namespace atrium::site_node
