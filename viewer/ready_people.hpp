#pragma once

#include "core/base/timestamp.hpp"
#include "viewer/renderer/person_model.hpp"

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

/// The next state of the person of one site.
struct PersonUpdate {
    using Clock = std::chrono::steady_clock;

    std::optional<renderer::PersonModel> model;  // none: nobody is there any more
    Timestamp capture_time;
    Clock::time_point complete{};  // when mesh and textures were there
    Clock::time_point ready{};     // when the model was
};

/// Decoded people on their way to the drawing thread: of each site the newest. Wakes the drawing
/// thread. Safe for any number of threads.
class ReadyPeople {
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

    /// Returns the update that it replaced, if any.
    std::optional<PersonUpdate> put(const std::string& site, PersonUpdate update);
    /// All that are there now; never waits.
    std::vector<Item> take_all();
    /// Who became ready since the last call, also those that were replaced or taken meanwhile; at
    /// most the newest kMostArrivals.
    std::vector<Arrival> take_arrivals();
    /// Returns once there are arrivals to take, at `until`, or when a stop is requested.
    void wait(const std::stop_token& stop, Clock::time_point until);

private:
    std::mutex mutex_;
    std::condition_variable_any changed_;
    std::map<std::string, PersonUpdate> newest_;
    std::vector<Arrival> arrivals_;
};

}  // namespace atrium::viewer
