#include "world_server/recorded_output.hpp"

#include "core/app/program.hpp"
#include "core/base/write_check.hpp"
#include "core/bus/checks.hpp"
#include "core/presence/membership.hpp"

#include <algorithm>
#include <array>
#include <chrono>
#include <utility>

namespace atrium::world_server {
namespace {

// Recorded time in one chunk: a player reads whole chunks to seek.
constexpr std::chrono::milliseconds kChunkTime{500};
constexpr std::uint64_t kSpareBytes = std::uint64_t{1} << 20U;

const std::array<std::string_view, 11> kOfWorldServers{bus::topic_name<bus::SceneObject>(),
                                                       bus::topic_name<bus::SoftBody>(),
                                                       bus::topic_name<bus::Scenery>(),
                                                       bus::topic_name<bus::SceneState>(),
                                                       bus::topic_name<bus::SoftBodyState>(),
                                                       bus::topic_name<bus::SitePlacement>(),
                                                       bus::topic_name<bus::PersonProxy>(),
                                                       bus::topic_name<bus::ObjectProxy>(),
                                                       bus::topic_name<bus::EditResult>(),
                                                       bus::topic_name<bus::SavedWorlds>(),
                                                       bus::topic_name<bus::WorldStatus>()};

}  // namespace

bool is_of_world_server(const bus::RawTopic& topic) {
    return std::ranges::find(kOfWorldServers, topic.name()) != kOfWorldServers.end();
}

Expected<std::unique_ptr<RecordingSink>> create_sink(const std::filesystem::path& file,
                                                     const recording::WorldFile& source) {
    if (auto can = check_folder_writable(
            std::filesystem::absolute(file).parent_path(), kSpareBytes, "a recording");
        !can)
        return tl::unexpected(can.error());
    recording::WriterOptions options;
    options.file = file;
    options.world = source.world();
    options.host = presence::host_name();
    options.version = app::version();
    auto writer = recording::WorldWriter::create(std::move(options));
    if (!writer) return tl::unexpected(writer.error());
    return std::make_unique<RecordingSink>(std::move(*writer));
}

void RecordingSink::write(recording::Recorded sample) {
    if (error_) return;
    auto done = writer_.write(sample);
    if (done && sample.time - flushed_ >= kChunkTime) {
        flushed_ = sample.time;
        // whatever waits, however short a time
        done = writer_.flush_due(std::chrono::steady_clock::time_point::max());
    }
    if (!done) error_ = done.error();
}

Expected<void> RecordingSink::finish() {
    const auto done = writer_.finish();
    if (error_) return tl::unexpected(*error_);
    return done;
}

template <typename Message>
Expected<std::size_t> RecordedWriter<Message>::write(const Message& message) {
    if (auto valid = bus::check(message); !valid) return tl::unexpected(valid.error());
    auto cdr = bus::to_cdr(message);
    const std::size_t num_bytes = cdr.size();
    sink_->write({topic_, bus::RawKind::kSample, sink_->time(), sink_->time(), std::move(cdr)});
    return num_bytes;
}

template <typename Message>
Expected<void> RecordedWriter<Message>::dispose(const Message& key_holder) {
    const auto whole = bus::to_cdr(key_holder);
    auto key = topic_->key_cdr({bus::RawKind::kDisposed, sink_->time(), whole});
    if (!key) return tl::unexpected(key.error());
    sink_->write({topic_, bus::RawKind::kDisposed, sink_->time(), sink_->time(), std::move(*key)});
    return {};
}

template class RecordedWriter<bus::SceneObject>;
template class RecordedWriter<bus::SoftBody>;
template class RecordedWriter<bus::Scenery>;
template class RecordedWriter<bus::SceneState>;
template class RecordedWriter<bus::SoftBodyState>;
template class RecordedWriter<bus::SitePlacement>;
template class RecordedWriter<bus::PersonProxy>;
template class RecordedWriter<bus::ObjectProxy>;
template class RecordedWriter<bus::EditResult>;
template class RecordedWriter<bus::SavedWorlds>;
template class RecordedWriter<bus::WorldStatus>;

RecordedOutputs::RecordedOutputs(RecordingSink& sink)
    : objects(sink),
      soft_bodies(sink),
      scenery(sink),
      states(sink),
      soft_states(sink),
      placements(sink),
      person_proxies(sink),
      object_proxies(sink),
      edit_results(sink),
      saved_worlds(sink),
      statuses(sink) {}

}  // namespace atrium::world_server
