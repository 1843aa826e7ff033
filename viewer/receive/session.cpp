#include "viewer/receive/session.hpp"

#include "core/bus/delays_from.hpp"
#include "core/bus/receive_threads.hpp"

#include <algorithm>
#include <thread>
#include <utility>

namespace atrium::viewer {
namespace {

constexpr std::chrono::milliseconds kLookAgain = Feedback::kOnTime / 2;
// the drawing thread takes them every few milliseconds
constexpr std::size_t kMaxWaitingStates = 8;
constexpr std::size_t kMaxPlacements = 64;          // as many as people shown
constexpr std::size_t kMaxStatuses = 64;            // of sites and of worlds, each
constexpr std::size_t kMaxWaitingSoftStates = 256;  // all soft objects together
constexpr std::size_t kMaxSpentModels = 4;          // kept to reuse their memory
constexpr std::size_t kMaxDecoders = 16;
// Share of the picture period: a pair that follows its predecessor sooner is skipped. Never affects
// a site slower than the pictures.
constexpr double kTooSoon = 0.6;

}  // namespace

Session::Session(Readers readers,
                 bus::Writer<bus::ViewerStatus> status,
                 bus::Writer<bus::SceneCommand> commands,
                 bus::Writer<bus::StreamFeedback> feedback_writer,
                 EditLink edits,
                 std::string viewer)
    : readers_(std::move(readers)),
      status_(std::move(status)),
      commands_(std::move(commands)),
      feedback_writer_(std::move(feedback_writer)),
      edits_(std::move(edits)),
      viewer_(std::move(viewer)) {}

void Session::receive(std::stop_token stop) {
    const std::stop_callback wake(stop, [this] { readers_.waiter.wake(); });
    bus::ReceiveThreads network;
    auto last_round = std::chrono::steady_clock::now();
    auto all_here = last_round;
    while (!stop.stop_requested()) {
        // While streams arrive, poll often to know when nothing waits. Order matters: read the
        // clock, then check that the network threads sleep, then empty the readers. Then no sample
        // from before that time is left.
        const bool has_samples =
            readers_.waiter.wait(feedback_.empty() ? Feedback::kPeriod : kLookAgain);
        const auto round = std::chrono::steady_clock::now();
        const Timestamp woken = Timestamp::now();
        const bool looks = round - all_here >= kLookAgain / 2;
        const bool is_all_here = looks && network.are_asleep();
        take_sites();
        if (looks) feedback_.looked(woken, is_all_here);
        if (is_all_here) all_here = round;
        if (has_samples || round - last_round >= Feedback::kPeriod) {
            last_round = round;
            take_others();
        }
        write_feedback();
    }
}

void Session::take_others() {
    take_objects();
    take_soft_objects();
    receive_statuses();
    note(proxies_.receive(readers_.participant));
    note(edits_.receive());
    num_incomplete_ = pairing_.num_incomplete();
}

void Session::receive_all() {
    take_sites();
    take_others();
    if (decoders_) decoders_->wait_until_idle();
}

void Session::take_sites() {
    // descriptions first: decoding a pair needs its cameras
    note(readers_.descriptions.take(
        [this](bus::SiteDescription&& description) {
            const std::string site = description.site;
            descriptions_[site] =
                std::make_shared<const bus::SiteDescription>(std::move(description));
            const std::lock_guard lock(scene_mutex_);
            scene_.sites[site] = descriptions_[site];
        },
        [this](const bus::SiteDescription& gone) {
            descriptions_.erase(gone.site);
            site_gone(gone.site);
            const std::lock_guard lock(scene_mutex_);
            scene_.sites[gone.site] = nullptr;
        }));
    note(readers_.placements.take([this](bus::SitePlacement&& placement) {
        if (site_from_world_.size() < kMaxPlacements || site_from_world_.contains(placement.site))
            site_from_world_[placement.site] = placement.world_from_site.inverse();
        const std::lock_guard lock(scene_mutex_);
        scene_.placements.insert_or_assign(placement.site, std::move(placement));
    }));
    note(readers_.meshes.take_written(
        [this](bus::SiteMesh&& mesh, Timestamp written) {
            const std::size_t num_bytes = mesh.draco.size();
            receive_sample(std::move(mesh), written, num_bytes);
        },
        [this](const bus::SiteMesh& gone, bus::Ending how) {
            site_gone(gone.site);
            if (how == bus::Ending::kDisposed) pairing_.start_over(gone.site);
        }));
    note(readers_.textures.take_written([this](bus::CameraTexture&& texture, Timestamp written) {
        const std::size_t num_bytes = texture.colour.size() + texture.mask.size();
        receive_sample(std::move(texture), written, num_bytes);
    }));
}

// Counts a sample and the pair that it completes.
template <typename Sample>
void Session::receive_sample(Sample&& sample, Timestamp written, std::size_t num_bytes) {
    const std::string site = sample.site;
    const Timestamp now = Timestamp::now();
    feedback_.arrived(site, written, sample.capture_time, num_bytes, now);
    num_bytes_ += num_bytes;
    const std::uint64_t num_incomplete = pairing_.num_incomplete();
    const std::uint64_t num_late = pairing_.num_late();
    auto pair = pairing_.add(std::forward<Sample>(sample));
    feedback_.lost(
        site, pairing_.num_incomplete() - num_incomplete, pairing_.num_late() - num_late);
    if (!pair) return;
    pair->delays_from = bus::delays_from(pair->mesh.capture_time, written);
    feedback_.completed(site, pair->mesh.frame_id, pair->delays_from, now);
    if (on_complete_) on_complete_(*pair);
    hand_to_decoder(std::move(pair));
}

void Session::write_feedback() {
    feedback_.report(viewer_, Timestamp::now(), [this](const bus::StreamFeedback& feedback) {
        if (const auto written = feedback_writer_.write(feedback); !written)
            rejections_.warn("feedback_failed " + written.error().message);
    });
}

void Session::take_objects() {
    const auto now = std::chrono::steady_clock::now();
    bool is_lost = false;
    note(readers_.objects.take(
        [this](bus::SceneObject&& object) {
            const std::lock_guard lock(scene_mutex_);
            scene_.objects.insert_or_assign(object.object, std::move(object));
        },
        [&](const bus::SceneObject& gone, bus::Ending how) {
            const std::lock_guard lock(scene_mutex_);
            scene_.objects.insert_or_assign(gone.object, std::nullopt);
            is_lost |= how == bus::Ending::kLost;
        }));
    const bool has_writer = readers_.objects.num_writers() > 0;
    is_lost |= std::exchange(has_object_writer_, has_writer) && !has_writer;
    if (is_lost) world_lost_ns_ = std::chrono::nanoseconds(now.time_since_epoch()).count();
    note(readers_.states.take(
        [&](bus::SceneState&& state) {
            const std::lock_guard lock(scene_mutex_);
            if (scene_.states.size() >= kMaxWaitingStates)
                scene_.states.erase(scene_.states.begin());
            scene_.states.emplace_back(std::move(state), now);
            world_heard_ns_ = std::chrono::nanoseconds(now.time_since_epoch()).count();
        },
        [this](const bus::SceneState& /*gone*/, bus::Ending how) {
            if (how != bus::Ending::kDisposed) return;
            // a recording that jumps, or another world server
            const std::lock_guard lock(scene_mutex_);
            scene_.is_new_time = true;
            scene_.states.clear();
        }));
}

void Session::receive_statuses() {
    const auto keep = [this](auto& statuses, const std::string& name, auto&& status) {
        const std::lock_guard lock(scene_mutex_);
        if (statuses.size() < kMaxStatuses || statuses.contains(name))
            statuses.insert_or_assign(name, std::forward<decltype(status)>(status));
    };
    note(readers_.site_statuses.take([&](bus::SiteStatus&& status) {
        const std::string site = status.site;
        keep(statuses_.sites, site, std::move(status));
    }));
    note(readers_.world_statuses.take([&](bus::WorldStatus&& status) {
        const std::string world = status.world;
        const auto now = std::chrono::steady_clock::now();
        world_heard_ns_ = std::chrono::nanoseconds(now.time_since_epoch()).count();
        keep(statuses_.worlds, world, std::move(status));
    }));
}

void Session::take_soft_objects() {
    note(readers_.soft_bodies.take(
        [this](bus::SoftBody&& body) {
            const std::lock_guard lock(scene_mutex_);
            scene_.soft_bodies.insert_or_assign(body.object, std::move(body));
        },
        [this](const bus::SoftBody& gone) {
            const std::lock_guard lock(scene_mutex_);
            scene_.soft_bodies.insert_or_assign(gone.object, std::nullopt);
        }));
    note(readers_.scenery.take(
        [this](bus::Scenery&& scenery) {
            const std::lock_guard lock(scene_mutex_);
            const std::string name = scenery.name;
            scene_.scenery.insert_or_assign(name, std::move(scenery));
        },
        [this](const bus::Scenery& gone) {
            const std::lock_guard lock(scene_mutex_);
            scene_.scenery.insert_or_assign(gone.name, std::nullopt);
        }));
    note(readers_.soft_states.take(
        [&](bus::SoftBodyState&& state) {
            const std::lock_guard lock(scene_mutex_);
            auto& waiting = scene_.soft_states;
            if (waiting.size() >= kMaxWaitingSoftStates) waiting.erase(waiting.begin());
            waiting.push_back(std::move(state));
        },
        [this](const bus::SoftBodyState& gone, bus::Ending how) {
            if (how != bus::Ending::kDisposed) return;
            const std::lock_guard lock(scene_mutex_);
            std::erase_if(scene_.soft_states, [&](const bus::SoftBodyState& state) {
                return state.object == gone.object;
            });
            scene_.soft_new_times.insert(gone.object);
        }));
}

void Session::hand_to_decoder(std::optional<FramePair> pair) {
    if (!pair) return;
    const std::string site = pair->mesh.site;
    if (!is_offline_ && stale_frames_.add(site, pair->delays_from, Timestamp::now())) {
        ++num_pairs_skipped_;  // stale: showing nothing is better than showing the past
        return;
    }
    const auto description = descriptions_.find(site);
    if (description == descriptions_.end()) {
        ++num_pairs_skipped_;  // its cameras are unknown
        return;
    }
    const auto now = DecodedPeople::Clock::now();
    if (decoders_ == nullptr || (!is_offline_ && is_too_soon(site, now))) {
        ++num_pairs_skipped_;
        return;
    }
    const auto replaced =
        decoders_->put(site, {std::move(pair), description->second, now, eyes_in(site)});
    if (replaced && replaced->pair) ++num_pairs_skipped_;
}

bool Session::is_too_soon(const std::string& site, DecodedPeople::Clock::time_point now) {
    const auto least = kTooSoon * std::chrono::nanoseconds(picture_period_ns_);
    const auto found = handed_.find(site);
    if (found != handed_.end() && now - found->second < least) return true;
    handed_[site] = now;
    return false;
}

void Session::set_eyes(std::vector<Eigen::Vector3d> eyes_world) {
    const std::lock_guard lock(eyes_mutex_);
    eyes_world_ = std::move(eyes_world);
}

std::vector<Eigen::Vector3f> Session::eyes_in(const std::string& site) {
    // the renderer also draws a site without placement at the world's origin
    const auto placement = site_from_world_.find(site);
    const geometry::RigidTransform site_from_world =
        placement == site_from_world_.end() ? geometry::RigidTransform{} : placement->second;
    std::vector<Eigen::Vector3f> eyes_site;
    const std::lock_guard lock(eyes_mutex_);
    for (const Eigen::Vector3d& eye : eyes_world_)
        eyes_site.push_back((site_from_world * eye).cast<float>());
    return eyes_site;
}

void Session::site_gone(const std::string& site) {
    pairing_.forget(site);
    stale_frames_.forget(site);
    handed_.erase(site);
    if (feedback_.forget(site)) {
        bus::StreamFeedback key;
        key.viewer = viewer_;
        key.site = site;
        if (const auto gone = feedback_writer_.dispose(key); !gone)
            rejections_.warn("feedback_failed " + gone.error().message);
    }
    if (decoders_ == nullptr) return;
    // queued, so no person decoded before reappears
    const auto replaced = decoders_->put(site, {});
    if (replaced && replaced->pair) ++num_pairs_skipped_;
}

void Session::note(const bus::TakeReport& report) {
    if (report.num_rejected == 0) return;
    num_rejected_ += report.num_rejected;
    rejections_.warn("sample_rejected " + report.first_rejection);
}

void Session::start_decoding() {
    const std::size_t num =
        std::clamp<std::size_t>(std::thread::hardware_concurrency(), std::size_t{1}, kMaxDecoders);
    scratch_.resize(num);
    decoders_ = std::make_unique<KeyedWorkers<Job>>(
        "decode", num, [this](const std::string& site, Job job, std::size_t worker) {
            decode(site, std::move(job), scratch_[worker]);
        });
}

void Session::stop_decoding() {
    if (decoders_) decoders_->stop();
}

void Session::decode(const std::string& site, Job job, PersonDecodeScratch& scratch) {
    PersonUpdate update;
    if (const auto& pair = job.pair) {
        update.capture_time = pair->mesh.capture_time;
        update.delays_from = pair->delays_from;
        update.complete = job.complete;
        if (!pair->mesh.draco.empty()) {
            update.model = spent();
            const auto decoded =
                decode_person(*pair, *job.description, {}, job.eyes_site, scratch, *update.model);
            if (!decoded) {
                ++num_rejected_;
                rejections_.warn("person_rejected site=" + site + " " + decoded.error().message);
                recycle(std::move(*update.model));
                return;
            }
            if (update.model->triangles.empty()) update.model.reset();
        }
    }
    update.ready = DecodedPeople::Clock::now();
    auto replaced = people_.put(site, std::move(update));
    if (replaced && replaced->model) skip(std::move(*replaced->model));
}

renderer::PersonModel Session::spent() {
    const std::lock_guard lock(spent_mutex_);
    if (spent_.empty()) return {};
    renderer::PersonModel model = std::move(spent_.back());
    spent_.pop_back();
    return model;
}

void Session::recycle(renderer::PersonModel model) {
    const std::lock_guard lock(spent_mutex_);
    if (spent_.size() < kMaxSpentModels) spent_.push_back(std::move(model));
}

SceneChanges Session::take_scene() {
    const std::lock_guard lock(scene_mutex_);
    return std::exchange(scene_, {});
}

StatusReports Session::take_statuses() {
    const std::lock_guard lock(scene_mutex_);
    return std::exchange(statuses_, {});
}

}  // namespace atrium::viewer
