#pragma once

#include "core/base/keyed_workers.hpp"
#include "core/base/statistics.hpp"
#include "core/bus/messages.hpp"
#include "world_server/people_inbox.hpp"
#include "world_server/person_preparation.hpp"

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
/// the simulation.
///
/// Prepares the meshes of one site in order, never two at once. A newer mesh of a site replaces one
/// that still waits; the dropped one is counted. After `lose` or `leave` returns, no earlier mesh
/// of the site reaches the inbox. Call `arrive`, `put`, `lose` and `leave` from one thread; they
/// never wait for a preparation.
class MeshPreparation final : public PersonPreparation {
public:
    /// A worker calls `reject` with the reason when it refuses a mesh.
    MeshPreparation(PeopleInbox& inbox,
                    std::size_t max_threads,
                    std::function<void(const std::string& why)> reject);
    ~MeshPreparation() override { stop(); }
    MeshPreparation(const MeshPreparation&) = delete;
    MeshPreparation& operator=(const MeshPreparation&) = delete;

    /// Returns one thread per core, at most four.
    static std::size_t threads_for_machine();

    void arrive(const std::string& site, MakeReader make_reader) override;
    void put(bus::SiteMesh message, Timestamp delays_from) override;
    void lose(const std::string& site) override;
    void leave(const std::string& site) override;

    /// Waits for running preparations. Nothing reaches the inbox afterwards.
    void stop() { workers_.stop(); }

    /// Number of meshes that were replaced before their preparation. Thread-safe.
    std::uint64_t num_dropped() const { return num_dropped_; }
    /// Times from `put` to the inbox. Thread-safe.
    Quantiles times() const;

private:
    using Clock = std::chrono::steady_clock;
    struct Person {   // from the site's arrival, or the loss of its last person, to the next loss
        Reader read;  // used by one worker at a time
        bool is_current = true;  // guarded by delivery_mutex_
    };
    struct Job {
        std::shared_ptr<Person> person;
        bus::SiteMesh message;
        Timestamp delays_from;
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
    std::map<std::string, Site> sites_;  // used only by the thread that calls `put`
    std::atomic<std::uint64_t> num_dropped_{0};
    std::mutex delivery_mutex_;       // makes the end of a person follow their last mesh
    mutable std::mutex times_mutex_;  // guards times_
    LatencyWindow times_;
    KeyedWorkers<Job> workers_;  // last member: the workers use all of the above
};

}  // namespace atrium::world_server
