#pragma once

#include "site_node/record/recording_session.hpp"

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <vector>

namespace atrium::record {

/// Memory for pictures between capture and the disk: a queue, and while nothing is recorded, a ring
/// of the newest ones. Pictures of one camera go to one writer, in order. In a full queue the
/// newest picture has no place: recordings need the older ones. Thread-safe; one thread adds.
class PictureQueue {
public:
    using Session = std::shared_ptr<RecordingSession>;

    struct Options {
        std::size_t num_writers = 1;
        std::size_t queue_bytes = 0;  // of pictures that wait
        std::size_t ring_bytes = 0;
        std::chrono::nanoseconds ring_time{};  // 0: no ring
    };
    struct Item {
        PictureToWrite picture;
        Session session;
        bool is_from_ring = false;  // has its own memory: does not fill the queue
    };

    explicit PictureQueue(const Options& options);

    /// Whether so many bytes more find a place.
    bool has_room(std::size_t num_bytes) const;

    /// Memory for a picture of so many bytes, from an earlier one if possible; nullopt: the queue
    /// is full.
    std::optional<std::vector<std::uint8_t>> reserve(std::size_t num_bytes);

    /// Adds a picture whose bytes are `reserve`d. Without a session it goes to the ring.
    void add(PictureToWrite picture, Session session);

    struct GivenRing {
        std::uint64_t first = 0;           // number from which the others are counted now
        std::vector<std::size_t> cameras;  // of each picture
    };
    /// From now on what is in the ring belongs to `session`; nullopt if it is empty.
    std::optional<GivenRing> give_ring_to(const Session& session);

    /// Next picture for `writer`; nullopt once a stop is requested.
    std::optional<Item> take(std::size_t writer, std::stop_token stop);
    /// Returns a taken item when it is written.
    void done(Item item);

    /// Waits until all pictures of `session` are written.
    void wait_until_done(const Session& session);

    std::size_t num_bytes_waiting() const;

private:
    bool fits(std::size_t num_bytes) const;
    void trim_ring();

    Options options_;
    mutable std::mutex mutex_;
    std::condition_variable_any added_;
    std::condition_variable done_;
    std::vector<std::deque<Item>> queues_;  // per writer
    std::deque<PictureToWrite> ring_;       // oldest first
    std::vector<std::vector<std::uint8_t>> spare_;
    std::vector<const RecordingSession*> being_written_;  // per writer
    std::size_t queued_bytes_ = 0;
    std::size_t ring_bytes_ = 0;
};

}  // namespace atrium::record
