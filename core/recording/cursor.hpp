#pragma once

#include "core/recording/world_file.hpp"

#include <optional>
#include <string>
#include <vector>

namespace atrium::recording {

/// Goes through the samples of a recording by their times, whatever chunks they are in. Holds the
/// chunks of the current time only. One thread at a time.
class Cursor {
public:
    /// Begins at the first sample.
    explicit Cursor(std::shared_ptr<const WorldFile> world);

    /// Continues with the first sample later than `time`, or from there on.
    void seek_behind(Timestamp time);
    void seek_to(Timestamp time);
    /// The next sample, or nullptr at the end. Stays the next one until `pop`.
    const PlayedSample* peek();
    void pop();

    /// Chunks that could not be read and were left out, and why the last of them.
    std::uint64_t num_damaged() const { return num_damaged_; }
    const std::string& damage() const { return damage_; }

private:
    struct Loaded {
        std::shared_ptr<const mcap::Chunk> chunk;
        std::size_t next = 0;
    };
    void load(std::size_t chunk);
    void load_all_before(std::optional<Timestamp> time);
    Loaded* earliest();

    std::shared_ptr<const WorldFile> world_;
    std::vector<std::size_t> order_;  // chunks by their first time
    std::size_t next_ = 0;            // in order_: not loaded yet
    std::vector<Loaded> loaded_;
    Timestamp from_;  // samples before it are left out
    std::optional<PlayedSample> current_;
    std::uint64_t num_damaged_ = 0;
    std::string damage_;
};

}  // namespace atrium::recording
