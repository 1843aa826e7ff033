#include "core/base/fingerprint.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

namespace atrium {
namespace {

namespace fs = std::filesystem;

class FingerprintTest : public testing::Test {
protected:
    void SetUp() override { fs::create_directories(folder_); }
    void TearDown() override { fs::remove_all(folder_); }

    fs::path write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return folder_ / name;
    }
    static Fingerprint of(const std::string& text) {
        return fingerprint_of({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()});
    }

    const fs::path folder_ =
        fs::temp_directory_path() / ("atrium-fingerprint-" + std::to_string(getpid()));
};

// The published test vectors of FNV-1a.
TEST_F(FingerprintTest, IsTheSizeAndTheHashOfTheBytes) {
    EXPECT_EQ(of(""), (Fingerprint{0, 0xcbf29ce484222325ULL}));
    EXPECT_EQ(of("a"), (Fingerprint{1, 0xaf63dc4c8601ec8cULL}));
    EXPECT_EQ(of("foobar"), (Fingerprint{6, 0x85944171f73967e8ULL}));
    EXPECT_TRUE(of("").is_known());
    EXPECT_FALSE(Fingerprint().is_known());
}

TEST_F(FingerprintTest, OfSeveralFilesDoesNotDependOnTheirOrder) {
    const Fingerprint a = of("a");
    const Fingerprint b = of("b");
    EXPECT_EQ(fingerprint_of(std::vector{a}), a);
    EXPECT_EQ(fingerprint_of({a, b}), fingerprint_of({b, a}));
    EXPECT_EQ(fingerprint_of({a, b}).num_bytes, 2U);
    EXPECT_NE(fingerprint_of({a, b}), fingerprint_of({a, a}));
    EXPECT_NE(fingerprint_of({a, b}), fingerprint_of({a, b, b}));
    EXPECT_FALSE(fingerprint_of(std::vector<Fingerprint>()).is_known());
}

TEST_F(FingerprintTest, OfAFileIsUnknownIfItCannotBeReadOrIsTooLarge) {
    const fs::path file = write("f", "foobar");
    EXPECT_EQ(fingerprint_of(file, 6), of("foobar"));
    EXPECT_FALSE(fingerprint_of(file, 5).is_known());
    EXPECT_FALSE(fingerprint_of(folder_ / "none", 6).is_known());
    EXPECT_FALSE(fingerprint_of(folder_, 6).is_known());
}

TEST_F(FingerprintTest, NoticesFilesThatChangeComeAndGo) {
    const fs::path file = write("f", "one");
    const fs::path beside = folder_ / "beside";
    const FilesRead read{of("one"), {{file, file_stamp(file)}, {beside, file_stamp(beside)}}};
    EXPECT_FALSE(read.have_changed());
    const auto time = fs::last_write_time(file);
    // an older copy of the same size and time, moved here
    fs::rename(write("g", "two"), file);
    fs::last_write_time(file, time);
    EXPECT_TRUE(read.have_changed());
    const FilesRead again{of("two"), {{file, file_stamp(file)}, {beside, file_stamp(beside)}}};
    EXPECT_FALSE(again.have_changed());
    write("beside", "");
    EXPECT_TRUE(again.have_changed());
    fs::remove(beside);
    EXPECT_FALSE(again.have_changed());
    fs::remove(file);
    EXPECT_TRUE(again.have_changed());
}

}  // namespace
}  // namespace atrium
