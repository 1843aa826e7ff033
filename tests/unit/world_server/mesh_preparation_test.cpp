#include "world_server/mesh_preparation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <initializer_list>
#include <map>
#include <memory>
#include <random>
#include <semaphore>
#include <string>
#include <thread>
#include <vector>

namespace atrium::world_server {
namespace {

constexpr Timestamp kWritten{1'000'000'000};

bus::SiteMesh mesh_of(const std::string& site, std::int64_t number) {
    bus::SiteMesh message;
    message.site = site;
    message.frame_id = static_cast<std::uint64_t>(number);
    message.capture_time = Timestamp{1'000'000'000 + number * 1'000'000};
    return message;
}

physics::PersonShape shape_of(const bus::SiteMesh& message) {
    physics::PersonShape shape;
    shape.surfels = std::make_shared<const std::vector<physics::MovingSurfel>>();
    shape.capture_time = message.capture_time;
    return shape;
}

using News = std::map<std::string, std::optional<physics::PersonShape>>;
News take(PeopleInbox& inbox) {
    News news;
    inbox.take_all([&](const std::string& site, std::optional<physics::PersonShape>&& shape) {
        news[site] = std::move(shape);
    });
    return news;
}

// A reader that blocks until the test releases it.
struct Gate {
    std::binary_semaphore began{0};
    std::binary_semaphore go_on{0};
    std::vector<std::uint64_t> read;

    MeshPreparation::MakeReader make_reader() {
        return [this] {
            return [this](const bus::SiteMesh& message) -> MeshPreparation::Result {
                read.push_back(message.frame_id);
                began.release();
                go_on.acquire();
                return shape_of(message);
            };
        };
    }
};

// Submits mesh 1 of alice. While it is read, submits the others in order, then waits until two are
// read.
struct WhileReading {
    PeopleInbox inbox;
    Gate gate;
    MeshPreparation sut{inbox, 2, [](const std::string&) { FAIL(); }};

    explicit WhileReading(std::initializer_list<int> others) {
        sut.arrive("alice", gate.make_reader());
        sut.put(mesh_of("alice", 1), kWritten);
        gate.began.acquire();
        for (const int number : others) sut.put(mesh_of("alice", number), kWritten);
        gate.go_on.release();
        gate.began.acquire();
        gate.go_on.release();
        sut.stop();
    }
};

TEST(MeshPreparation, PreparesTheNewestWaitingMeshAndCountsTheRest) {
    WhileReading after({2, 3, 4, 5});
    EXPECT_EQ(after.gate.read, (std::vector<std::uint64_t>{1, 5}));
    EXPECT_EQ(after.sut.num_dropped(), 3U);
    EXPECT_EQ(after.sut.times().num_samples, 2U);
    const News news = take(after.inbox);
    ASSERT_TRUE(news.contains("alice") && news.at("alice"));
    EXPECT_EQ(news.at("alice")->capture_time, mesh_of("alice", 5).capture_time);
}

TEST(MeshPreparation, KeepsTheNewerMeshIfAnOlderArrivesLate) {
    WhileReading after({3, 2});
    EXPECT_EQ(after.gate.read, (std::vector<std::uint64_t>{1, 3}));
    EXPECT_EQ(after.sut.num_dropped(), 1U);
}

TEST(MeshPreparation, DeliversNothingOfALostPerson) {
    PeopleInbox inbox;
    Gate gate;
    MeshPreparation sut(inbox, 1, [](const std::string&) { FAIL(); });
    sut.arrive("alice", gate.make_reader());
    sut.put(mesh_of("alice", 1), kWritten);
    gate.began.acquire();
    sut.put(mesh_of("alice", 2), kWritten);  // waits, and is cancelled too
    sut.lose("alice");
    News news = take(inbox);
    ASSERT_TRUE(news.contains("alice"));
    EXPECT_FALSE(news.at("alice").has_value());
    // the only worker has prepared another site's mesh, so those of alice are done
    Gate other;
    sut.arrive("bob", other.make_reader());
    sut.put(mesh_of("bob", 1), kWritten);
    gate.go_on.release();
    other.began.acquire();
    other.go_on.release();
    sut.stop();
    news = take(inbox);
    EXPECT_FALSE(news.contains("alice"));
    EXPECT_TRUE(news.contains("bob"));
    EXPECT_EQ(gate.read, (std::vector<std::uint64_t>{1}));
}

TEST(MeshPreparation, RestartsForASiteThatReturns) {
    PeopleInbox inbox;
    std::atomic<int> num_readers = 0;
    std::atomic<int> num_read = 0;
    MeshPreparation sut(inbox, 2, [](const std::string&) { FAIL(); });
    const auto make_reader = [&] {
        ++num_readers;
        return [&](const bus::SiteMesh& message) -> MeshPreparation::Result {
            ++num_read;
            return shape_of(message);
        };
    };
    sut.arrive("alice", make_reader);
    sut.arrive("alice", make_reader);  // already present
    EXPECT_EQ(num_readers, 1);
    sut.leave("alice");
    sut.leave("alice");
    sut.arrive("alice", make_reader);
    EXPECT_EQ(num_readers, 2);
    sut.put(mesh_of("alice", 1), kWritten);
    while (num_read == 0) std::this_thread::yield();
    sut.stop();
    EXPECT_TRUE(take(inbox).at("alice").has_value());
}

TEST(MeshPreparation, ReportsMeshesThatAReaderRefuses) {
    PeopleInbox inbox;
    std::atomic<int> num_refused = 0;
    MeshPreparation sut(inbox, 2, [&](const std::string& why) {
        EXPECT_EQ(why, "broken");
        ++num_refused;
    });
    sut.arrive("alice", [] {
        return [](const bus::SiteMesh&) -> MeshPreparation::Result {
            return make_error(ErrorKind::kInvalidData, "broken");
        };
    });
    sut.put(mesh_of("alice", 1), kWritten);
    while (num_refused == 0) std::this_thread::yield();
    sut.stop();
    EXPECT_TRUE(take(inbox).empty());
}

// Sites appear, disappear and lose people at random while their meshes are prepared. Each
// preparation yields the scheduler a random number of times. The step takes the results meanwhile.
TEST(MeshPreparation, KeepsTheOrderOfEachSite) {
    constexpr int kSites = 5;
    constexpr int kEvents = 4'000;
    for (unsigned seed = 0; seed < 4; ++seed) {
        struct Site {
            std::atomic<bool> is_busy = false;
            std::atomic<std::int64_t> num_read = 0;
            bool is_there = false;
            std::int64_t last_put = 0;  // number of the mesh, or 0 if it was cancelled since
            std::int64_t last_taken = 0;
            std::int64_t ended_at = 0;  // no mesh up to this number may be taken after the end
        };
        std::array<Site, kSites> sites;
        std::atomic<bool> is_right = true;
        PeopleInbox inbox;
        MeshPreparation sut(inbox, 1 + seed, [](const std::string&) { FAIL(); });
        std::atomic<unsigned> salt = seed;
        const auto maker_for = [&](Site& site) {
            return [&] {
                // the meshes of one person come in the order of their capture
                auto last = std::make_shared<std::uint64_t>(0);
                return [&, last](const bus::SiteMesh& message) -> MeshPreparation::Result {
                    if (site.is_busy.exchange(true)) is_right = false;
                    if (message.frame_id <= *last) is_right = false;
                    *last = message.frame_id;
                    for (unsigned turn = ++salt % 7; turn > 0; --turn) std::this_thread::yield();
                    ++site.num_read;
                    site.is_busy = false;
                    return shape_of(message);
                };
            };
        };
        const auto step = [&] {
            for (const auto& [name, shape] : take(inbox)) {
                Site& site = sites.at(static_cast<std::size_t>(name.front() - 'a'));
                if (!shape) continue;
                const std::int64_t number = (shape->capture_time.ns - 1'000'000'000) / 1'000'000;
                if (number <= site.last_taken || number <= site.ended_at) is_right = false;
                site.last_taken = number;
            }
        };
        std::mt19937 random(seed);
        std::int64_t number = 0;
        for (int event = 0; event < kEvents; ++event) {
            const auto index = static_cast<std::size_t>(random() % kSites);
            Site& site = sites.at(index);
            const std::string name(1, static_cast<char>('a' + index));
            const unsigned what = random() % 100;
            if (!site.is_there) {
                sut.arrive(name, maker_for(site));
                site.is_there = true;
            } else if (what < 90) {
                sut.put(mesh_of(name, ++number), kWritten);
                site.last_put = number;
            } else if (what < 96) {
                step();  // meshes from before the end may be used until now
                what < 94 ? sut.lose(name) : sut.leave(name);
                site.is_there = what < 94;
                site.ended_at = number;
                site.last_put = 0;
            } else {
                step();
            }
        }
        // the newest of each site is prepared without a further `put`
        const auto all_taken = [&] {
            step();
            return std::all_of(sites.begin(), sites.end(), [](const Site& site) {
                return site.last_put == 0 || site.last_taken == site.last_put;
            });
        };
        while (is_right && !all_taken()) std::this_thread::yield();
        sut.stop();
        EXPECT_TRUE(is_right) << "seed " << seed;
    }
}

}  // namespace
}  // namespace atrium::world_server
