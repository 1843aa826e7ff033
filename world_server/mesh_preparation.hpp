#pragma once

#include "core/base/expected.hpp"
#include "core/base/keyed_workers.hpp"
#include "core/base/statistics.hpp"
#include "core/bus/messages.hpp"
#include "world_server/people_inbox.hpp"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace atrium::world_server {

/// Decodes and prepares the sites' meshes on worker threads and puts the results into the inbox of
/// the step.
///
/// The meshes of one site are prepared in order and never two at once. A mesh that still waits is
/// dropped and counted when a newer one of its site comes. Once `lose` or `leave` returns, no
/// earlier mesh of the site reaches the inbox. `arrive`, `put`, `lose` and `leave` are for one
/// thread; they never wait for a preparation.
class MeshPreparation {
public:
    using Result = Expected<std::optional<physics::PersonShape>>;
    /// Reads the meshes of one person of one site. Called by one thread at a time.
    using Reader = std::function<Result(const bus::SiteMesh&)>;
    /// Makes a reader without a past; called by the thread that calls `arrive` and `lose`.
    using MakeReader = std::function<Reader()>;

    /// `reject` is told by a worker why a mesh was refused.
    MeshPreparation(PeopleInbox& inbox,
                    std::size_t max_threads,
                    std::function<void(const std::string& why)> reject);
    ~MeshPreparation() { stop(); }
    MeshPreparation(const MeshPreparation&) = delete;
    MeshPreparation& operator=(const MeshPreparation&) = delete;

    /// One thread for each core, at most four.
    static std::size_t threads_for_machine();

    void arrive(const std::string& site, MakeReader make_reader);
    /// The site must have arrived.
    void put(bus::SiteMesh message);
    /// Nobody is in the site any more; its next mesh is of a new person.
    void lose(const std::string& site);
    void leave(const std::string& site);

    /// Waits for the preparations that run; nothing reaches the inbox afterwards.
    void stop() { workers_.stop(); }

    /// Meshes that a newer one of their site replaced before they were prepared. Thread-safe, as is
    /// the next one.
    std::uint64_t num_dropped() const { return num_dropped_; }
    /// From `put` to the inbox.
    Quantiles times() const;

private:
    using Clock = std::chrono::steady_clock;
    struct Person {   // from the arrival of a site, or its loss of a person, to the next loss
        Reader read;  // of one worker at a time
        bool is_current = true;  // guarded by delivery_mutex_
    };
    struct Job {
        std::shared_ptr<Person> person;
        bus::SiteMesh message;
        Clock::time_point since;
    };
    struct Site {
        MakeReader make_reader;
        std::shared_ptr<Person> person;
    };

    void prepare(const std::string& site, Job job);
    void end(const std::string& site, Person& person);

    PeopleInbox& inbox_;
    const std::function<void(const std::string& why)> reject_;
    std::map<std::string, Site> sites_;  // of the thread that puts
    std::atomic<std::uint64_t> num_dropped_{0};
    std::mutex delivery_mutex_;       // orders the end of a person after her last mesh
    mutable std::mutex times_mutex_;  // guards the next one
    LatencyWindow times_;
    KeyedWorkers<Job> workers_;  // last: they use all of the above
};

}  // namespace atrium::world_server
