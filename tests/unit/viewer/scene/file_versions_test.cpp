#include "viewer/scene/file_versions.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace atrium::viewer {
namespace {

using Key = FileVersions::Key;
using Keys = std::vector<Key>;
constexpr Fingerprint kOld{5, 11};
constexpr Fingerprint kNew{6, 12};
constexpr Fingerprint kNewer{7, 13};
const Key kKettle("kettle.glb", 1.0);

class FileVersionsTest : public testing::Test {
protected:
    // Reads the file for the first time.
    bool read(const Key& key, const Fingerprint& own) {
        versions_.begin(key, now_);
        return versions_.end(key, own);
    }
    void wait() { now_ += FileVersions::kPeriod; }

    FileVersions versions_{4};
    FileVersions::Clock::time_point now_{std::chrono::hours(1)};
};

TEST_F(FileVersionsTest, LeavesEqualAndUnknownVersionsAlone) {
    versions_.expect("kettle.glb", kOld);
    EXPECT_FALSE(read(kKettle, kOld));
    EXPECT_FALSE(read({"unnamed.glb", 1.0}, kOld));
    versions_.expect("kettle.glb", {});
    versions_.expect("unnamed.glb", {});
    wait();
    EXPECT_EQ(versions_.take_due(now_), Keys{});
    EXPECT_FALSE(versions_.is_different(kKettle));
}

TEST_F(FileVersionsTest, LooksAgainWhenTheServerHasANewVersionBeforeItSaysSo) {
    versions_.expect("kettle.glb", kOld);
    read(kKettle, kOld);
    wait();
    versions_.expect("kettle.glb", kNew);
    EXPECT_FALSE(versions_.is_different(kKettle)) << "it may have been replaced here, too";
    EXPECT_EQ(versions_.take_due(now_), Keys{kKettle});
    EXPECT_EQ(versions_.take_due(now_ + 2 * FileVersions::kPeriod), Keys{}) << "it is being read";
    EXPECT_FALSE(versions_.is_different(kKettle));
    EXPECT_FALSE(versions_.end(kKettle, kNew));
    wait();
    EXPECT_EQ(versions_.take_due(now_), Keys{});
}

TEST_F(FileVersionsTest, SaysOnceThatAFileDiffersAndLooksOnceAPeriod) {
    versions_.expect("kettle.glb", kNew);
    EXPECT_TRUE(read(kKettle, kOld));
    EXPECT_TRUE(versions_.is_different(kKettle));
    EXPECT_EQ(versions_.take_due(now_), Keys{});
    for (int i = 0; i < 3; ++i) {
        wait();
        EXPECT_EQ(versions_.take_due(now_), Keys{kKettle});
        EXPECT_TRUE(versions_.is_different(kKettle)) << "until it was read";
        EXPECT_FALSE(versions_.end(kKettle, std::nullopt)) << "said already";
        EXPECT_TRUE(versions_.is_different(kKettle));
    }
    versions_.expect("kettle.glb", kNewer);
    wait();
    EXPECT_EQ(versions_.take_due(now_), Keys{kKettle});
    EXPECT_TRUE(versions_.end(kKettle, std::nullopt)) << "of another version";
    wait();
    EXPECT_EQ(versions_.take_due(now_), Keys{kKettle});
    EXPECT_FALSE(versions_.end(kKettle, kNewer));
    EXPECT_FALSE(versions_.is_different(kKettle));
}

TEST_F(FileVersionsTest, DoesNotBlameAFileForAVersionThatCameWhileItWasRead) {
    versions_.expect("kettle.glb", kOld);
    versions_.begin(kKettle, now_);
    versions_.expect("kettle.glb", kNew);
    EXPECT_FALSE(versions_.end(kKettle, kOld));
    EXPECT_FALSE(versions_.is_different(kKettle));
    wait();
    EXPECT_EQ(versions_.take_due(now_), Keys{kKettle});
    EXPECT_TRUE(versions_.end(kKettle, std::nullopt));
}

TEST_F(FileVersionsTest, LooksAgainForAMissingFileButDoesNotCallItDifferent) {
    versions_.expect("kettle.glb", kNew);
    EXPECT_FALSE(read(kKettle, {}));
    EXPECT_FALSE(versions_.is_different(kKettle));
    wait();
    EXPECT_EQ(versions_.take_due(now_), Keys{kKettle});
}

TEST_F(FileVersionsTest, ComparesEachScaleOfAFile) {
    const Key small("kettle.glb", 0.1);
    read(kKettle, kOld);
    read(small, kOld);
    read({"kettle.glc", 1.0}, kOld);
    wait();
    versions_.expect("kettle.glb", kNew);
    EXPECT_EQ(versions_.take_due(now_), (Keys{small, kKettle}));
    EXPECT_FALSE(versions_.end(small, kNew));
    EXPECT_TRUE(versions_.end(kKettle, kOld));
    EXPECT_FALSE(versions_.is_different(small));
    EXPECT_TRUE(versions_.is_different(kKettle));
}

// A server that changes its mind all the time, and one that names ever new files.
TEST_F(FileVersionsTest, BoundsWhatAHostileServerCauses) {
    read(kKettle, kOld);
    int num_looks = 0;
    int num_said = 0;
    for (std::uint64_t i = 1; i <= 1000; ++i) {
        now_ += std::chrono::milliseconds(10);
        versions_.expect("kettle.glb", {1, i + 100});
        versions_.expect("file" + std::to_string(i), {1, i});
        for (const Key& key : versions_.take_due(now_)) {
            ++num_looks;
            num_said += versions_.end(key, std::nullopt) ? 1 : 0;
        }
    }
    EXPECT_EQ(num_looks, 10);
    EXPECT_EQ(num_said, 4) << "as many as files are kept";
    read({"file1", 1.0}, kOld);
    read({"file9", 1.0}, kOld);
    EXPECT_FALSE(versions_.is_different({"file9", 1.0})) << "beyond the limit";
}

TEST_F(FileVersionsTest, ForgetsAllButWhatItSaid) {
    versions_.expect("kettle.glb", kNew);
    EXPECT_TRUE(read(kKettle, kOld));
    versions_.forget();
    EXPECT_FALSE(versions_.is_different(kKettle));
    EXPECT_EQ(versions_.num_read(), 0U);
    wait();
    EXPECT_EQ(versions_.take_due(now_), Keys{});
    versions_.expect("kettle.glb", kNew);
    EXPECT_FALSE(read(kKettle, kOld)) << "said already";
    EXPECT_TRUE(versions_.is_different(kKettle));
}

}  // namespace
}  // namespace atrium::viewer
