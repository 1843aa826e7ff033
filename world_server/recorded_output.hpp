#pragma once

#include "core/bus/messages.hpp"
#include "core/recording/world_file.hpp"
#include "core/recording/world_writer.hpp"

#include <filesystem>
#include <memory>
#include <optional>

namespace atrium::world_server {

/// Writes a recording again. Used by one thread.
class RecordingSink {
public:
    explicit RecordingSink(recording::WorldWriter writer) : writer_(std::move(writer)) {}

    /// What is written from now on has this time.
    void set_time(Timestamp time) { time_ = time; }
    Timestamp time() const { return time_; }
    /// After the first error writes no more; `finish` returns it.
    void write(recording::Recorded sample);
    bool has_failed() const { return error_.has_value(); }
    Expected<void> finish();

private:
    recording::WorldWriter writer_;
    Timestamp time_;
    Timestamp flushed_;
    std::optional<Error> error_;
};

/// As bus::Writer, into a recording.
template <typename Message>
class RecordedWriter {
public:
    explicit RecordedWriter(RecordingSink& sink)
        : sink_(&sink), topic_(bus::find_raw_topic(bus::topic_name<Message>())) {}

    Expected<std::size_t> write(const Message& message);
    Expected<void> dispose(const Message& key_holder);
    int num_readers() const { return 0; }  // nobody asks for proxies of people

private:
    RecordingSink* sink_;
    const bus::RawTopic* topic_;
};

/// The topics of a world server, as in Endpoints.
struct RecordedOutputs {
    RecordedWriter<bus::SceneObject> objects;
    RecordedWriter<bus::SoftBody> soft_bodies;
    RecordedWriter<bus::Scenery> scenery;
    RecordedWriter<bus::SceneState> states;
    RecordedWriter<bus::SoftBodyState> soft_states;
    RecordedWriter<bus::SitePlacement> placements;
    RecordedWriter<bus::PersonProxy> person_proxies;
    RecordedWriter<bus::ObjectProxy> object_proxies;
    RecordedWriter<bus::EditResult> edit_results;
    RecordedWriter<bus::SavedWorlds> saved_worlds;
    RecordedWriter<bus::WorldStatus> statuses;

    explicit RecordedOutputs(RecordingSink& sink);
};

/// True if a world server publishes this topic.
bool is_of_world_server(const bus::RawTopic& topic);

/// Creates the file. Fails if it exists, or cannot be written.
Expected<std::unique_ptr<RecordingSink>> create_sink(const std::filesystem::path& file,
                                                     const recording::WorldFile& source);

}  // namespace atrium::world_server
