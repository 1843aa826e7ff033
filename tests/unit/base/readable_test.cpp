#include "core/base/readable.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

// Permissions, which root does not feel, are tested by the rows of tests/causes.
namespace atrium {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Readable : public testing::Test {
protected:
    void SetUp() override { std::ofstream(file_) << "x"; }
    void TearDown() override { fs::remove(file_); }

    const fs::path folder_ = testing::TempDir();
    const fs::path file_ = folder_ / "readable_test_file";
};

TEST_F(Readable, FilesAreNoFolders) {
    EXPECT_TRUE(check_readable(file_));
    EXPECT_THAT(check_readable(folder_).error().message, HasSubstr(": is a folder, not a file"));
}

TEST_F(Readable, FoldersAreNoFiles) {
    EXPECT_TRUE(check_folder_readable(folder_));
    const auto file = check_folder_readable(file_);
    ASSERT_FALSE(file);
    EXPECT_THAT(file.error().message, HasSubstr("readable_test_file: is a file, not a folder"));
}

TEST_F(Readable, WhatIsMissingIsNotFound) {
    for (const fs::path& missing : {folder_ / "readable_test_none", file_ / "inside"}) {
        EXPECT_EQ(check_readable(missing).error().kind, ErrorKind::kNotFound);
        const auto folder = check_folder_readable(missing);
        ASSERT_FALSE(folder);
        EXPECT_EQ(folder.error().kind, ErrorKind::kNotFound);
        EXPECT_THAT(folder.error().message, HasSubstr(": there is no such folder"));
    }
}

}  // namespace
}  // namespace atrium
