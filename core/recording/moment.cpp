#include "core/recording/moment.hpp"

#include "core/bus/messages.hpp"
#include "core/recording/cursor.hpp"
#include "core/recording/topic_roles.hpp"

#include <algorithm>
#include <map>
#include <set>

namespace atrium::recording {
namespace {

constexpr std::chrono::seconds kStreamWindow{1};
constexpr std::chrono::milliseconds kStatusWindow{2500};

using InstanceKey = std::pair<const bus::RawTopic*, std::string>;

// A recorder that joins is told within this time what was there before it.
constexpr std::chrono::seconds kJoining{1};

// What is kept and still alive, in the order in which it was written. What came first of an
// instance while the recorder joined was there before.
std::vector<KeyedSample> kept_at(const WorldFile& world, Timestamp time) {
    const Timestamp joined = time < world.begin() ? time : world.begin() + kJoining;
    std::map<InstanceKey, const WorldFile::Kept*> alive;
    std::set<InstanceKey> known;
    for (const WorldFile::Kept& kept : world.kept()) {
        if (kept.sample.time > std::max(time, joined)) break;
        const InstanceKey key{kept.sample.topic, kept.key};
        const bool is_first = known.insert(key).second;
        if (kept.sample.time > time && !is_first) continue;
        if (kept.sample.raw.kind == bus::RawKind::kSample)
            alive[key] = &kept;
        else
            alive.erase(key);
    }
    std::vector<KeyedSample> samples;
    for (const auto& [key, kept] : alive) samples.push_back({kept->sample, kept->key});
    std::ranges::stable_sort(samples, {}, [](const KeyedSample& one) { return one.sample.time; });
    return samples;
}

// The newest mesh of each site whose textures are all there, and these textures.
class NewestFrames {
public:
    explicit NewestFrames(const std::vector<PlayedSample>& recent) : recent_(recent) {}

    void add_to(std::vector<KeyedSample>& out) {
        std::set<std::string> done;
        for (auto sample = recent_.rbegin(); sample != recent_.rend(); ++sample) {
            if (sample->topic->name() != "SiteMesh") continue;
            const auto mesh = bus::from_raw<bus::SiteMesh>(sample->raw);
            if (!mesh || done.contains(mesh->site)) continue;
            if (sample->raw.kind != bus::RawKind::kSample) {
                done.insert(mesh->site);  // it ended
                continue;
            }
            std::vector<KeyedSample> textures;
            if (!find_textures(*mesh, textures)) continue;
            done.insert(mesh->site);
            out.push_back({*sample, mesh->site});
            out.insert(out.end(), textures.begin(), textures.end());
        }
    }

private:
    struct Texture {
        const PlayedSample* sample;
        std::string site;
        std::uint32_t camera;
        bus::FrameKey frame;
    };

    // Textures are read when a mesh first asks for them: there are many.
    void read_textures() {
        if (is_read_) return;
        is_read_ = true;
        for (auto sample = recent_.rbegin(); sample != recent_.rend(); ++sample) {
            if (sample->topic->name() != "CameraTexture") continue;
            if (sample->raw.kind != bus::RawKind::kSample) continue;
            const auto texture = bus::from_raw<bus::CameraTexture>(sample->raw);
            if (!texture) continue;
            textures_.push_back({&*sample,
                                 texture->site,
                                 texture->camera,
                                 {texture->frame_id, texture->capture_time}});
        }
    }

    bool find_textures(const bus::SiteMesh& mesh, std::vector<KeyedSample>& out) {
        if (!mesh.textured_cameras.empty()) read_textures();
        for (std::size_t i = 0; i < mesh.textured_cameras.size(); ++i) {
            const bus::FrameKey frame = bus::texture_frame(mesh, i);
            const auto found = std::ranges::find_if(textures_, [&](const Texture& texture) {
                return texture.site == mesh.site && texture.camera == mesh.textured_cameras[i] &&
                       texture.frame == frame;
            });
            if (found == textures_.end()) return false;
            out.push_back({*found->sample, mesh.site + "/" + std::to_string(found->camera)});
        }
        return true;
    }

    const std::vector<PlayedSample>& recent_;
    std::vector<Texture> textures_;  // newest first
    bool is_read_ = false;
};

}  // namespace

std::vector<KeyedSample> moment(const std::shared_ptr<const WorldFile>& world, Timestamp time) {
    std::vector<KeyedSample> samples = kept_at(*world, time);
    std::vector<PlayedSample> people;
    std::map<InstanceKey, PlayedSample> last;  // of states and statuses
    Cursor cursor(world);
    cursor.seek_to(time + -kStatusWindow);
    for (const PlayedSample* next = cursor.peek(); next != nullptr && next->time <= time;
         cursor.pop(), next = cursor.peek()) {
        const bus::RawTopic& topic = *next->topic;
        if (is_kept(topic) || is_command(topic)) continue;
        const bool is_status = topic.qos_class() == "status";
        if (!is_status && next->time < time + -kStreamWindow) continue;
        if (is_of_people(topic)) {
            people.push_back(*next);
        } else if (auto key = topic.key_of(next->raw)) {
            if (next->raw.kind == bus::RawKind::kSample)
                last.insert_or_assign({&topic, std::move(*key)}, *next);
            else
                last.erase({&topic, std::move(*key)});
        }
    }
    NewestFrames(people).add_to(samples);
    std::vector<KeyedSample> states;
    for (auto& [key, sample] : last) states.push_back({std::move(sample), key.second});
    std::ranges::stable_sort(states, {}, [](const KeyedSample& one) { return one.sample.time; });
    std::ranges::move(states, std::back_inserter(samples));
    return samples;
}

}  // namespace atrium::recording
