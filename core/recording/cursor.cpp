#include "core/recording/cursor.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace atrium::recording {
namespace {

// Chunks of one time that are held at once: a recorder's are two, of 4 MiB each.
constexpr std::size_t kMaxLoadedBytes = std::size_t{1} << 30U;

}  // namespace

Cursor::Cursor(std::shared_ptr<const WorldFile> world) : world_(std::move(world)) {
    const auto& chunks = world_->file().contents().chunks;
    order_.resize(chunks.size());
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    std::ranges::stable_sort(order_, {}, [&](std::size_t i) { return chunks[i].first; });
    seek_to(world_->begin());
}

void Cursor::seek_behind(Timestamp time) { seek_to({time.ns + 1}); }

void Cursor::seek_to(Timestamp time) {
    from_ = time;
    next_ = 0;
    loaded_.clear();
    current_.reset();
}

void Cursor::load(std::size_t number) {
    std::size_t num_bytes = 0;
    for (const Loaded& one : loaded_) num_bytes += one.chunk->records.size();
    if (num_bytes > kMaxLoadedBytes) {
        ++num_damaged_;
        damage_ = world_->file().path().string() + ": too many chunks of the same time";
        return;
    }
    auto read = world_->file().read(number);
    if (!read) {
        ++num_damaged_;
        damage_ = read.error().message;
        return;
    }
    Loaded loaded{std::make_shared<const mcap::Chunk>(std::move(*read)), 0};
    const auto& messages = loaded.chunk->messages;
    const auto first = std::ranges::lower_bound(messages, from_, {}, &mcap::Message::log_time);
    loaded.next = static_cast<std::size_t>(first - messages.begin());
    if (loaded.next < messages.size()) loaded_.push_back(std::move(loaded));
}

// Loads the chunks that may have samples before `time`; without it, the next one.
void Cursor::load_all_before(std::optional<Timestamp> time) {
    const auto& chunks = world_->file().contents().chunks;
    while (next_ < order_.size()) {
        const std::size_t number = order_[next_];
        if (time && chunks[number].first > *time) return;
        ++next_;
        if (chunks[number].last < from_) continue;
        load(number);
        if (!time && !loaded_.empty())
            time = loaded_.back().chunk->messages[loaded_.back().next].log_time;
    }
}

Cursor::Loaded* Cursor::earliest() {
    const auto time = [](const Loaded& loaded) {
        return loaded.chunk->messages[loaded.next].log_time;
    };
    const auto found = std::ranges::min_element(loaded_, {}, time);
    return found == loaded_.end() ? nullptr : &*found;
}

const PlayedSample* Cursor::peek() {
    while (!current_) {
        if (const Loaded* first = earliest())
            load_all_before(first->chunk->messages[first->next].log_time);
        else
            load_all_before(std::nullopt);
        Loaded* const loaded = earliest();
        if (loaded == nullptr) return nullptr;
        const mcap::Message& message = loaded->chunk->messages[loaded->next];
        const RecordedChannel known = world_->channel(message.channel);
        if (known.topic != nullptr) {
            current_ = PlayedSample{message.log_time,
                                    known.topic,
                                    {known.kind, message.publish_time, message.data},
                                    loaded->chunk};
        }
        if (++loaded->next == loaded->chunk->messages.size())
            loaded_.erase(loaded_.begin() + (loaded - loaded_.data()));
    }
    return &*current_;
}

void Cursor::pop() { current_.reset(); }

}  // namespace atrium::recording
