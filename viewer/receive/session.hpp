#pragma once

#include "core/app/log.hpp"
#include "core/base/expected.hpp"
#include "core/base/keyed_workers.hpp"
#include "core/bus/bus.hpp"
#include "viewer/receive/decoded_people.hpp"
#include "viewer/receive/edit_link.hpp"
#include "viewer/receive/feedback.hpp"
#include "viewer/receive/pairing.hpp"
#include "viewer/receive/person_decoder.hpp"
#include "viewer/receive/proxy_inbox.hpp"
#include "viewer/receive/stale_frames.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <stop_token>
#include <string>
#include <utility>
#include <vector>

namespace atrium::viewer {

/// Changes of the scene since the last call of `take_scene`.
struct SceneChanges {
    std::map<std::uint32_t, std::optional<bus::SceneObject>> objects;   // nullopt: removed
    std::map<std::uint32_t, std::optional<bus::SoftBody>> soft_bodies;  // nullopt: removed
    std::map<std::string, std::optional<bus::Scenery>> scenery;         // nullopt: removed
    std::vector<bus::SoftBodyState> soft_states;
    std::map<std::string, bus::SitePlacement> placements;
    std::map<std::string, std::shared_ptr<const bus::SiteDescription>> sites;  // null: gone
    /// `states` begin anew: those before belong to another time.
    bool is_new_time = false;
    std::set<std::uint32_t> soft_new_times;  // soft objects whose states begin anew
    std::vector<std::pair<bus::SceneState, std::chrono::steady_clock::time_point>> states;
};

/// Status reports since the last call of `take_statuses`.
struct StatusReports {
    std::map<std::string, bus::SiteStatus> sites;
    std::map<std::string, bus::WorldStatus> worlds;
};

/// Receives the world's topics and writes the viewer's own. `receive` is the body of a thread that
/// the owner starts; other threads may call everything else.
///
/// Queues: a complete pair waits for a decoder and a decoded person waits for the drawing thread,
/// one per site, newest wins. Pairs of one site are decoded in order, one at a time; pairs of
/// different sites in parallel, on at most as many threads as the machine has.
class Session {
public:
    /// Sites receive the stream feedback under the name `viewer`.
    static Expected<std::unique_ptr<Session>> create(const bus::BusOptions& options,
                                                     const std::string& viewer);

    /// Calls `listener` on the receiving thread for each complete frame. Call it before `receive`.
    void on_complete(std::function<void(const FramePair&)> listener) {
        on_complete_ = std::move(listener);
    }
    void receive(std::stop_token stop);
    /// Without `receive`: takes all that is there and waits until it is decoded.
    void receive_all();
    /// For `receive_all`: no pair is too old or too early, and nobody is told of it.
    void plays_offline() { is_offline_ = true; }
    /// Starts the decoders. Call it before `receive`; without it, complete pairs are skipped.
    void start_decoding();
    /// Waits for the running decoders. Call it after `receive` has returned.
    void stop_decoding();
    /// Sets the period of the pictures: a pair that a newer one would replace before the next
    /// picture is skipped before decoding. 0, the default: all are decoded. Any thread.
    void set_picture_period(std::chrono::nanoseconds period) {
        picture_period_ns_ = period.count();
    }

    /// Sets the eyes that look at people, in the world: only the textures that these eyes need are
    /// decoded (renderer::needed_cameras). None, the default: all are decoded. Any thread.
    void set_eyes(std::vector<Eigen::Vector3d> eyes_world);

    std::vector<DecodedPeople::Item> take_people() { return people_.take_all(); }
    std::vector<DecodedPeople::Arrival> take_arrivals() { return people_.take_arrivals(); }
    /// Blocks until there are arrivals, until `until`, or until a stop is requested.
    void wait_for_people(const std::stop_token& stop, DecodedPeople::Clock::time_point until) {
        people_.wait(stop, until);
    }
    SceneChanges take_scene();
    StatusReports take_statuses();
    /// Time of the last state or status of a world server. Empty: none yet.
    std::optional<std::chrono::steady_clock::time_point> world_heard() const {
        const std::int64_t ns = world_heard_ns_;
        if (ns == 0) return std::nullopt;
        return std::chrono::steady_clock::time_point(std::chrono::nanoseconds(ns));
    }
    /// Time at which objects of the world were last found to have no writer any more: their world
    /// server has ended or is cut off. Empty: never.
    std::optional<std::chrono::steady_clock::time_point> world_lost() const {
        const std::int64_t ns = world_lost_ns_;
        if (ns == 0) return std::nullopt;
        return std::chrono::steady_clock::time_point(std::chrono::nanoseconds(ns));
    }
    /// Physics proxies of people and models, received on demand.
    ProxyInbox& proxies() { return proxies_; }
    /// Returns a model that is no longer shown; the decoder reuses its memory.
    void recycle(renderer::PersonModel model);
    /// Returns a model that was taken but will not be shown, and counts it as skipped.
    void skip(renderer::PersonModel model) {
        ++num_pairs_skipped_;
        recycle(std::move(model));
    }

    Expected<std::size_t> publish(const bus::ViewerStatus& status) { return status_.write(status); }
    Expected<std::size_t> send(const bus::SceneCommand& command) {
        return commands_.write(command);
    }

    /// Edits of the world and their results.
    EditLink& edits() { return edits_; }

    const bus::Participant& participant() const { return readers_.participant; }
    /// Deadlines of the QoS profile that a site or the world missed.
    std::uint64_t num_deadlines_missed() const {
        return readers_.meshes.num_deadlines_missed() + readers_.states.num_deadlines_missed();
    }
    /// Complete pairs that were not shown: replaced by a newer one, stale, too early for the next
    /// picture, or of an unknown site.
    std::uint64_t num_pairs_skipped() const { return num_pairs_skipped_; }
    std::uint64_t num_incomplete() const { return num_incomplete_; }
    std::uint64_t num_rejected() const { return num_rejected_; }
    /// Received bytes of meshes and textures, as encoded.
    std::uint64_t num_bytes() const { return num_bytes_; }

private:
    struct Readers {
        bus::Participant participant;
        bus::Waiter waiter;
        bus::Reader<bus::SiteDescription> descriptions;
        bus::Reader<bus::SitePlacement> placements;
        bus::Reader<bus::SiteMesh> meshes;
        bus::Reader<bus::CameraTexture> textures;
        bus::Reader<bus::SceneObject> objects;
        bus::Reader<bus::SoftBody> soft_bodies;
        bus::Reader<bus::SoftBodyState> soft_states;
        bus::Reader<bus::Scenery> scenery;
        bus::Reader<bus::SceneState> states;
        bus::Reader<bus::SiteStatus> site_statuses;
        bus::Reader<bus::WorldStatus> world_statuses;
    };
    using Description = std::shared_ptr<const bus::SiteDescription>;
    struct Job {
        std::optional<FramePair> pair;  // none: the site is gone
        Description description;
        DecodedPeople::Clock::time_point complete{};
        std::vector<Eigen::Vector3f> eyes_site;
    };

    Session(Readers readers,
            bus::Writer<bus::ViewerStatus> status,
            bus::Writer<bus::SceneCommand> commands,
            bus::Writer<bus::StreamFeedback> feedback_writer,
            EditLink edits,
            std::string viewer);
    void take_sites();
    void take_others();
    void take_objects();
    void take_soft_objects();
    void receive_statuses();
    void hand_to_decoder(std::optional<FramePair> pair);
    bool is_too_soon(const std::string& site, DecodedPeople::Clock::time_point now);
    std::vector<Eigen::Vector3f> eyes_in(const std::string& site);
    void decode(const std::string& site, Job job, PersonDecodeScratch& scratch);
    renderer::PersonModel spent();
    template <typename Sample>
    void receive_sample(Sample&& sample, Timestamp written, std::size_t num_bytes);
    void write_feedback();
    void site_gone(const std::string& site);
    void note(const bus::TakeReport& report);

    Readers readers_;
    bus::Writer<bus::ViewerStatus> status_;
    bus::Writer<bus::SceneCommand> commands_;
    bus::Writer<bus::StreamFeedback> feedback_writer_;
    EditLink edits_;
    std::string viewer_;
    std::function<void(const FramePair&)> on_complete_;
    Pairing pairing_;
    Feedback feedback_;  // receiving thread only
    ProxyInbox proxies_;
    StaleFrames stale_frames_;                         // receiving thread only
    std::map<std::string, Description> descriptions_;  // of the receiving thread alone
    std::map<std::string, geometry::RigidTransform> site_from_world_;  // receiving thread only
    std::mutex eyes_mutex_;
    std::vector<Eigen::Vector3d> eyes_world_;  // guarded by eyes_mutex_
    // when a pair of each site was last handed to a decoder; receiving thread only
    std::map<std::string, DecodedPeople::Clock::time_point> handed_;
    std::atomic<std::int64_t> picture_period_ns_ = 0;
    bool is_offline_ = false;
    DecodedPeople people_;
    std::mutex spent_mutex_;
    std::vector<renderer::PersonModel> spent_;  // guarded by spent_mutex_
    std::mutex scene_mutex_;
    SceneChanges scene_;
    StatusReports statuses_;  // also guarded by scene_mutex_
    app::log::OncePerSecond rejections_;
    std::atomic<std::int64_t> world_heard_ns_ = 0;  // steady clock; 0: never
    bool has_object_writer_ = false;                // receiving thread only
    std::atomic<std::int64_t> world_lost_ns_ = 0;   // as world_heard_ns_
    std::atomic<std::uint64_t> num_pairs_skipped_ = 0;
    std::atomic<std::uint64_t> num_incomplete_ = 0;
    std::atomic<std::uint64_t> num_rejected_ = 0;
    std::atomic<std::uint64_t> num_bytes_ = 0;
    std::vector<PersonDecodeScratch> scratch_;  // one per decoder
    /// Last: the decoder threads use the other members.
    std::unique_ptr<KeyedWorkers<Job>> decoders_;
};

}  // namespace atrium::viewer
