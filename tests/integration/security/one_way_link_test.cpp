#include "core/keys/store.hpp"
#include "tests/support/network/impaired_network.hpp"
#include "tests/support/skips.hpp"
#include "tests/support/source_dir.hpp"
#include "tests/support/temporary_folder.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <memory>
#include <thread>

// A link that works in one direction only for a while: of two programs with keys one loses the
// other, who does not notice.
namespace atrium::test {
namespace {

using namespace std::chrono_literals;

enum Host : int { kSite, kListener, kNumHosts };

class OneWayLink : public testing::TestWithParam<Way> {
protected:
    void SetUp() override {
        auto network = ImpairedNetwork::create(kNumHosts, 41);
        if (!network) GTEST_SKIP() << skip::kNoNetwork << network.error().message;
        network_ = std::move(*network);
    }
    template <typename T>
    static T value(Expected<T> expected) {
        if (!expected) throw std::runtime_error(expected.error().message);
        return std::move(*expected);
    }
    std::string bundle(keys::KeyStore& store, keys::Kind kind, const std::string& name) {
        value(store.add({"playroom", kind, name, {}}, 90, Timestamp::now()));
        const auto file = (folder_ / (name + ".bundle")).string();
        std::ofstream(file) << keys::bundle_text(value(store.bundle(name)));
        std::filesystem::permissions(file, std::filesystem::perms{0600});
        return file;
    }
    std::unique_ptr<HostedProcess> start(int host, std::vector<std::string> command) {
        command.front() = std::string(ATRIUM_BIN_DIR) + "/" + command.front();
        command.insert(command.end(), {"--bus.network", "lan"});
        return value(network_->start(host, command));
    }

    TemporaryFolder folder_;
    std::unique_ptr<ImpairedNetwork> network_;
};

TEST_P(OneWayLink, StreamsComeBack) {
    auto store =
        value(keys::KeyStore::create(folder_ / "playroom.keys", "playroom", 365, Timestamp::now()));
    const auto site = start(kSite,
                            {"site_node",
                             "--config",
                             source_dir() + "/deploy/sites/alice.toml",
                             "--security",
                             bundle(store, keys::Kind::kSite, "alice")});
    const auto listener = start(
        kListener, {"stream_watch", "--security", bundle(store, keys::Kind::kMonitor, "mona")});
    ASSERT_TRUE(listener->wait_for_output("first alice", 60s)) << site->output();
    // nobody gives up a listener that has nothing to say
    std::this_thread::sleep_for(18s);
    EXPECT_EQ(listener->output().find("gap"), std::string::npos) << listener->output();
    EXPECT_EQ(site->output().find("cut_off"), std::string::npos) << site->output();
    // Longer than the lease of participants (10 s), shorter than it takes to give up a silent one.
    network_->set(kListener, GetParam(), {.loss = 1.0});
    std::this_thread::sleep_for(13s);
    network_->set(kListener, GetParam(), {});
    EXPECT_TRUE(listener->wait_for_output("gap alice", 60s))
        << site->output() << listener->output();
    listener->signal(SIGTERM);
    EXPECT_TRUE(listener->wait(20s));
    std::printf("%s", listener->output().c_str());
    site->signal(SIGTERM);
    EXPECT_TRUE(site->wait(20s));
}

INSTANTIATE_TEST_SUITE_P(Ways,
                         OneWayLink,
                         testing::Values(Way::kUp, Way::kDown),
                         [](const auto& way) {
                             return way.param == Way::kUp ? "ListenerIsNotHeard" : "SiteIsNotHeard";
                         });

}  // namespace
}  // namespace atrium::test
