#pragma once

#include "core/recording/world_file.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <stop_token>
#include <thread>
#include <vector>

namespace atrium::viewer {

/// A small picture of a moment of a recording: the people as one camera each sees them, side by
/// side.
struct Thumbnail {
    static constexpr int kWidth = 96;  // [px]
    static constexpr int kHeight = 64;
    std::vector<std::uint8_t> rgba;  // kWidth * kHeight * 4; empty: not made yet
};

/// Makes thumbnails of evenly spaced moments on a thread of its own, at the lowest priority.
class Thumbnails {
public:
    static constexpr std::size_t kNum = 16;

    explicit Thumbnails(std::shared_ptr<const recording::WorldFile> world);

    /// The thumbnails made so far. `revision` grows with each. Thread-safe.
    std::vector<Thumbnail> all() const;
    std::size_t revision() const;

private:
    void make(const std::stop_token& stop);

    std::shared_ptr<const recording::WorldFile> world_;
    mutable std::mutex mutex_;
    std::vector<Thumbnail> made_;  // guarded by mutex_
    std::size_t revision_ = 0;     // guarded by mutex_
    std::jthread thread_;          // last: uses the others
};

/// The picture of one moment. Without people it is the background only.
Thumbnail make_thumbnail(const std::shared_ptr<const recording::WorldFile>& world, Timestamp time);

}  // namespace atrium::viewer
