#include "site_node/record/picture_queue.hpp"

#include <algorithm>
#include <utility>

namespace atrium::record {

PictureQueue::PictureQueue(const Options& options)
    : options_(options), queues_(options.num_writers), being_written_(options.num_writers) {}

// One picture always has a place, or a small queue would never take any.
bool PictureQueue::fits(std::size_t num_bytes) const {
    return queued_bytes_ == 0 || queued_bytes_ + num_bytes <= options_.queue_bytes;
}

bool PictureQueue::has_room(std::size_t num_bytes) const {
    const std::lock_guard lock(mutex_);
    return fits(num_bytes);
}

std::optional<std::vector<std::uint8_t>> PictureQueue::reserve(std::size_t num_bytes) {
    std::vector<std::uint8_t> memory;
    const std::lock_guard lock(mutex_);
    if (!fits(num_bytes)) return std::nullopt;
    if (!spare_.empty()) {
        memory.swap(spare_.back());
        spare_.pop_back();
    }
    return memory;
}

void PictureQueue::add(PictureToWrite picture, Session session) {
    {
        const std::lock_guard lock(mutex_);
        if (session == nullptr) {
            ring_bytes_ += picture.packed.size();
            ring_.push_back(std::move(picture));
            trim_ring();
            return;
        }
        queued_bytes_ += picture.packed.size();
        auto& queue = queues_[picture.camera % queues_.size()];
        queue.push_back({std::move(picture), std::move(session), false});
    }
    added_.notify_all();
}

// Whole instants only.
void PictureQueue::trim_ring() {
    const Timestamp newest = ring_.back().capture_time;
    std::optional<std::uint64_t> trimmed;
    while (!ring_.empty() && (ring_bytes_ > options_.ring_bytes ||
                              newest - ring_.front().capture_time > options_.ring_time ||
                              trimmed == ring_.front().number)) {
        trimmed = ring_.front().number;
        ring_bytes_ -= ring_.front().packed.size();
        spare_.push_back(std::move(ring_.front().packed));
        ring_.pop_front();
    }
}

std::optional<PictureQueue::GivenRing> PictureQueue::give_ring_to(const Session& session) {
    GivenRing given;
    {
        const std::lock_guard lock(mutex_);
        if (ring_.empty()) return std::nullopt;
        given.first = std::ranges::min_element(ring_, {}, &PictureToWrite::number)->number;
        for (PictureToWrite& picture : ring_) {
            picture.number -= given.first;
            given.cameras.push_back(picture.camera);
            auto& queue = queues_[picture.camera % queues_.size()];
            queue.push_back({std::move(picture), session, true});
        }
        ring_.clear();
        ring_bytes_ = 0;
    }
    added_.notify_all();
    return given;
}

std::optional<PictureQueue::Item> PictureQueue::take(std::size_t writer, std::stop_token stop) {
    std::unique_lock lock(mutex_);
    std::deque<Item>& queue = queues_[writer];
    if (!added_.wait(lock, stop, [&] { return !queue.empty(); })) return std::nullopt;
    Item item = std::move(queue.front());
    queue.pop_front();
    being_written_[writer] = item.session.get();
    return item;
}

void PictureQueue::done(Item item) {
    {
        const std::lock_guard lock(mutex_);
        const std::size_t writer = item.picture.camera % queues_.size();
        being_written_[writer] = nullptr;
        if (!item.is_from_ring) queued_bytes_ -= item.picture.packed.size();
        spare_.push_back(std::move(item.picture.packed));
    }
    done_.notify_all();
}

void PictureQueue::wait_until_done(const Session& session) {
    std::unique_lock lock(mutex_);
    done_.wait(lock, [&] {
        return std::ranges::none_of(being_written_,
                                    [&](const auto* own) { return own == session.get(); }) &&
               std::ranges::all_of(queues_, [&](const auto& queue) {
                   return std::ranges::none_of(
                       queue, [&](const Item& item) { return item.session == session; });
               });
    });
}

std::size_t PictureQueue::num_bytes_waiting() const {
    const std::lock_guard lock(mutex_);
    return queued_bytes_;
}

}  // namespace atrium::record
