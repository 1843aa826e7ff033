#pragma once

#include "core/recording/cursor.hpp"
#include "world_server/person_preparation.hpp"
#include "world_server/reception.hpp"
#include "world_server/task_lanes.hpp"

#include <cstdint>
#include <deque>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

namespace atrium::world_server {

/// A shape that is prepared or will soon be.
struct PreparedShape {
    std::string site;
    std::future<PersonPreparation::Result> shape;
};
struct EndedPerson {
    std::string site;
};
/// The sender of commands or edits has left.
struct EndedCommands {
    bus::SceneCommand key;
};
struct EndedEdits {
    bus::SceneEdit key;
};
using RecordedNews = std::variant<bus::SitePlacement,
                                  PreparedShape,
                                  EndedPerson,
                                  bus::SceneCommand,
                                  EndedCommands,
                                  bus::SceneEdit,
                                  EndedEdits>;

/// A sample of a recording, and its news for the simulation.
struct RecordedItem {
    recording::PlayedSample sample;
    std::vector<RecordedNews> news;  // empty: the sample is of no use to a world server
};

/// The samples of a recording in their order, as a world server receives them.
///
/// Reads ahead, so that meshes are prepared on threads while the simulation computes. The news and
/// their order depend only on the recording, not on the threads. Uses each mesh. Used by one
/// thread.
class RecordedInput final : private PersonPreparation {
public:
    /// Calls `reject` with the reason when it refuses a site or a sample.
    RecordedInput(const WorldServerConfig& config,
                  std::shared_ptr<const recording::WorldFile> world,
                  std::size_t num_threads,
                  std::function<void(const std::string& why)> reject);
    ~RecordedInput() override = default;

    /// Returns the next sample that was recorded until `time`; nullopt if there is none.
    std::optional<RecordedItem> next(Timestamp time);

    std::uint64_t num_sites() const { return reception_.num_present(); }
    std::uint64_t num_meshes() const { return num_meshes_; }
    /// Chunks that could not be read and were left out.
    std::uint64_t num_damaged() const { return cursor_.num_damaged(); }

private:
    struct Site {
        MakeReader make_reader;
        Reader read;
        std::size_t lane = 0;
    };
    void arrive(const std::string& site, MakeReader make_reader) override;
    void put(bus::SiteMesh message, Timestamp delays_from) override;
    void lose(const std::string& site) override;
    void leave(const std::string& site) override;

    void read_ahead();
    void read(const recording::PlayedSample& sample);
    void add(RecordedNews news);
    template <typename Message, typename OnSample, typename OnEnd>
    void hand_over(const recording::PlayedSample& sample, OnSample on_sample, OnEnd on_end);

    const bool has_commands_;
    const std::size_t max_meshes_ahead_;
    const std::function<void(const std::string& why)> reject_;
    recording::Cursor cursor_;
    Reception reception_;
    std::map<std::string, Site> sites_;
    std::deque<RecordedItem> ahead_;  // the last one is being read
    std::size_t num_meshes_ahead_ = 0;
    std::size_t next_lane_ = 0;
    std::uint64_t num_meshes_ = 0;
    TaskLanes<Result> lanes_;
};

}  // namespace atrium::world_server
