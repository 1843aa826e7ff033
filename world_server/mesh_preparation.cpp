#include "world_server/mesh_preparation.hpp"

#include "world_server/site_reader.hpp"

#include <algorithm>
#include <cassert>
#include <thread>
#include <utility>

namespace atrium::world_server {

MeshPreparation::MeshPreparation(PeopleInbox& inbox,
                                 std::size_t max_threads,
                                 std::function<void(const std::string& why)> reject)
    : inbox_(inbox),
      reject_(std::move(reject)),
      workers_("prepare", max_threads, [this](const std::string& site, Job job, std::size_t) {
          prepare(site, std::move(job));
      }) {}

std::size_t MeshPreparation::threads_for_machine() {
    return std::clamp<std::size_t>(std::thread::hardware_concurrency(), 1, 4);
}

void MeshPreparation::arrive(const std::string& site, MakeReader make_reader) {
    if (sites_.contains(site)) return;
    Site& arrived = sites_[site];
    arrived.person = std::make_shared<Person>();
    arrived.person->read = make_reader();
    arrived.make_reader = std::move(make_reader);
}

void MeshPreparation::put(bus::SiteMesh message, Timestamp delays_from) {
    const std::string site = message.site;
    const auto found = sites_.find(site);
    assert(found != sites_.end());
    const Timestamp capture = message.capture_time;
    std::optional<Job> replaced =
        workers_.put(site, {found->second.person, std::move(message), delays_from, Clock::now()});
    if (!replaced || replaced->person != found->second.person) return;
    ++num_dropped_;
    // a late sample must not replace a newer one: put the newer one back; the reader refuses the
    // late one if it has already been prepared
    if (is_out_of_order(capture, replaced->message.capture_time))
        workers_.put(site, std::move(*replaced));
}

void MeshPreparation::end(const std::string& site, Person& person) {
    const std::lock_guard lock(delivery_mutex_);
    person.is_current = false;
    inbox_.put(site, std::nullopt);
}

void MeshPreparation::lose(const std::string& site) {
    const auto found = sites_.find(site);
    if (found == sites_.end()) return;
    end(site, *found->second.person);
    found->second.person = std::make_shared<Person>();
    found->second.person->read = found->second.make_reader();
}

void MeshPreparation::leave(const std::string& site) {
    const auto found = sites_.find(site);
    if (found == sites_.end()) return;
    end(site, *found->second.person);
    sites_.erase(found);
}

void MeshPreparation::prepare(const std::string& site, Job job) {
    const auto is_current = [&] {
        const std::lock_guard lock(delivery_mutex_);
        return job.person->is_current;
    };
    if (!is_current()) return;
    Result shape = job.person->read(job.message);
    if (!shape) return reject_(shape.error().message);
    if (*shape) (*shape)->delays_from = job.delays_from;
    {
        const std::lock_guard lock(delivery_mutex_);
        if (!job.person->is_current) return;
        inbox_.put(site, std::move(*shape));
    }
    const std::lock_guard lock(times_mutex_);
    times_.add(Clock::now() - job.since);
}

Quantiles MeshPreparation::times() const {
    const std::lock_guard lock(times_mutex_);
    return times_.quantiles();
}

}  // namespace atrium::world_server
