#pragma once

#include "core/base/timestamp.hpp"
#include "viewer/renderer/person/person_model.hpp"

#include <chrono>
#include <condition_variable>
#include <cstddef>
#include <map>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

namespace atrium::viewer {

/// New state of the person of one site.
struct PersonUpdate {
    using Clock = std::chrono::steady_clock;

    std::optional<renderer::PersonModel> model;  // none: nobody is there any more
    Timestamp capture_time;
    Timestamp delays_from;         // see bus::delays_from
    Clock::time_point complete{};  // mesh and textures were there
    Clock::time_point ready{};     // the model was ready
};

/// Hands decoded people to the drawing thread, the newest of each site, and wakes it. Thread-safe.
class DecodedPeople {
public:
    using Clock = PersonUpdate::Clock;
    struct Item {
        std::string site;
        PersonUpdate update;
    };
    struct Arrival {
        std::string site;
        Clock::time_point at;
    };
    static constexpr std::size_t kMostArrivals = 256;

    /// Stores the update of `site`. Returns the update that it replaced, if any.
    std::optional<PersonUpdate> put(const std::string& site, PersonUpdate update);
    /// Takes all updates. Never blocks.
    std::vector<Item> take_all();
    /// Returns the arrivals since the last call, including updates that were replaced or taken
    /// since. Keeps the newest kMostArrivals.
    std::vector<Arrival> take_arrivals();
    /// Blocks until there are arrivals, until `until`, or until a stop is requested.
    void wait(const std::stop_token& stop, Clock::time_point until);

private:
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::map<std::string, PersonUpdate> newest_;
    std::vector<Arrival> arrivals_;
};

}  // namespace atrium::viewer
