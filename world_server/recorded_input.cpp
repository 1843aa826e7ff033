#include "world_server/recorded_input.hpp"

#include <algorithm>
#include <type_traits>
#include <utility>

namespace atrium::world_server {
namespace {

constexpr std::size_t kMeshesAheadPerLane = 8;
constexpr std::size_t kSamplesAhead = 1024;  // they keep chunks in memory

}  // namespace

RecordedInput::RecordedInput(const WorldServerConfig& config,
                             std::shared_ptr<const recording::WorldFile> world,
                             std::size_t num_threads,
                             std::function<void(const std::string& why)> reject)
    : has_commands_(config.recording.commands),
      max_meshes_ahead_(kMeshesAheadPerLane * std::max<std::size_t>(1, num_threads)),
      reject_(std::move(reject)),
      cursor_(std::move(world)),
      reception_(
          config, *this, [this](const bus::SitePlacement& placement) { add(placement); }, reject_),
      lanes_(num_threads) {}

void RecordedInput::add(RecordedNews news) { ahead_.back().news.push_back(std::move(news)); }

void RecordedInput::arrive(const std::string& site, MakeReader make_reader) {
    Site& arrived = sites_[site];
    arrived.read = make_reader();
    arrived.make_reader = std::move(make_reader);
    arrived.lane = next_lane_++ % lanes_.num_lanes();
}

void RecordedInput::put(bus::SiteMesh message, Timestamp delays_from) {
    const std::string name = message.site;
    const Site& site = sites_.at(name);
    std::packaged_task<Result()> task([read = site.read, mesh = std::move(message), delays_from] {
        Result shape = read(mesh);
        if (shape && *shape) (*shape)->delays_from = delays_from;
        return shape;
    });
    ++num_meshes_;
    ++num_meshes_ahead_;
    add(PreparedShape{name, lanes_.put(site.lane, std::move(task))});
}

void RecordedInput::lose(const std::string& site) {
    const auto found = sites_.find(site);
    if (found == sites_.end()) return;
    found->second.read = found->second.make_reader();
    add(EndedPerson{site});
}

void RecordedInput::leave(const std::string& site) {
    if (sites_.erase(site) > 0) add(EndedPerson{site});
}

template <typename Message, typename OnSample, typename OnEnd>
void RecordedInput::hand_over(const recording::PlayedSample& sample,
                              OnSample on_sample,
                              OnEnd on_end) {
    auto message = bus::from_raw<Message>(sample.raw);
    if (!message)
        return reject_(std::string(sample.topic->name()) + ": " + message.error().message);
    if (sample.raw.kind == bus::RawKind::kSample)
        on_sample(std::move(*message));
    else
        on_end(*message);
}

void RecordedInput::read(const recording::PlayedSample& sample) {
    const std::string_view topic = sample.topic->name();
    if (topic == bus::topic_name<bus::SiteMesh>()) {
        hand_over<bus::SiteMesh>(
            sample,
            [&](bus::SiteMesh&& mesh) { reception_.put(std::move(mesh), sample.raw.written); },
            [&](const bus::SiteMesh& gone) { reception_.end(gone); });
    } else if (topic == bus::topic_name<bus::SiteDescription>()) {
        hand_over<bus::SiteDescription>(
            sample,
            [&](bus::SiteDescription&& description) { reception_.put(description); },
            [&](const bus::SiteDescription& gone) { reception_.end(gone); });
    } else if (has_commands_ && topic == bus::topic_name<bus::SceneCommand>()) {
        hand_over<bus::SceneCommand>(
            sample,
            [&](bus::SceneCommand&& command) { add(std::move(command)); },
            [&](const bus::SceneCommand& gone) { add(EndedCommands{gone}); });
    } else if (has_commands_ && topic == bus::topic_name<bus::SceneEdit>()) {
        hand_over<bus::SceneEdit>(
            sample,
            [&](bus::SceneEdit&& edit) { add(std::move(edit)); },
            [&](const bus::SceneEdit& gone) { add(EndedEdits{gone}); });
    }
}

void RecordedInput::read_ahead() {
    while (num_meshes_ahead_ < max_meshes_ahead_ && ahead_.size() < kSamplesAhead) {
        const recording::PlayedSample* const sample = cursor_.peek();
        if (sample == nullptr) return;
        ahead_.push_back({*sample, {}});
        cursor_.pop();
        read(ahead_.back().sample);
    }
}

std::optional<RecordedItem> RecordedInput::next(Timestamp time) {
    read_ahead();
    if (ahead_.empty() || ahead_.front().sample.time > time) return std::nullopt;
    RecordedItem item = std::move(ahead_.front());
    ahead_.pop_front();
    const auto is_shape = [](const RecordedNews& news) {
        return std::holds_alternative<PreparedShape>(news);
    };
    num_meshes_ahead_ -=
        static_cast<std::size_t>(std::count_if(item.news.begin(), item.news.end(), is_shape));
    return item;
}

}  // namespace atrium::world_server
