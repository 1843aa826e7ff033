#include "tools/export/formats/output_file.hpp"

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/export/ball_person.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>

namespace atrium::exporting {
namespace {

TEST(OutputFile, HasItsNameOnlyWhenItIsWhole) {
    const test::TemporaryFolder folder;
    {
        auto file = OutputFile::create(folder / "a.obj");
        ASSERT_TRUE(file) << file.error().message;
        ASSERT_TRUE(file->write("half"));
        EXPECT_EQ(testing::names_in(folder / ""), (std::vector<std::string>{"a.obj.part"}));
        OutputFile moved = std::move(*file);
        EXPECT_EQ(testing::names_in(folder / "").size(), 1u);
    }
    EXPECT_TRUE(testing::names_in(folder / "").empty());
    auto file = OutputFile::create(folder / "a.obj");
    ASSERT_TRUE(file);
    ASSERT_TRUE(file->write("whole"));
    EXPECT_EQ(file->num_bytes(), 5u);
    ASSERT_TRUE(file->commit());
    EXPECT_EQ(testing::names_in(folder / ""), (std::vector<std::string>{"a.obj"}));
}

TEST(OutputFile, KeepsTheFormerFileUntilItIsWhole) {
    const test::TemporaryFolder folder;
    const std::vector<std::uint8_t> old_bytes{1, 2, 3};
    ASSERT_TRUE(write_file(folder / "a", old_bytes));
    {
        auto file = OutputFile::create(folder / "a");
        ASSERT_TRUE(file);
        ASSERT_TRUE(file->write("new"));
    }
    EXPECT_EQ(testing::bytes_of(folder / "a"), old_bytes);
}

TEST(OutputFile, NamesWhatIsMissing) {
    const test::TemporaryFolder folder;
    const auto file = OutputFile::create(folder / "no" / "a.glb");
    ASSERT_FALSE(file);
    EXPECT_EQ(file.error().kind, ErrorKind::kUnavailable);
    EXPECT_NE(file.error().message.find("create the folder"), std::string::npos);
}

// A limit on the size of files stands for a full disk.
TEST(OutputFile, RemovesWhatDidNotFitOnTheDisk) {
    const test::TemporaryFolder folder;
    rlimit former{};
    ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &former), 0);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    rlimit small = former;
    small.rlim_cur = 1000;
    ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
    const auto done = write_file(folder / "a.glb", std::vector<std::uint8_t>(5000, 1));
    setrlimit(RLIMIT_FSIZE, &former);
    std::signal(SIGXFSZ, handler);
    ASSERT_FALSE(done);
    EXPECT_EQ(done.error().kind, ErrorKind::kUnavailable);
    EXPECT_TRUE(testing::names_in(folder / "").empty());
}

}  // namespace
}  // namespace atrium::exporting
