#include "core/base/write_check.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

namespace atrium {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(CheckFolderWritable, AcceptsAFolderThatDoesNotExistYetAndMakesNone) {
    const fs::path folder = fs::path(testing::TempDir()) / "not_yet" / "there";
    const auto fits = check_folder_writable(folder, 1, "out");
    EXPECT_TRUE(fits) << fits.error().message;
    EXPECT_FALSE(fs::exists(folder.parent_path()));
}

TEST(CheckFolderWritable, NamesAFullDisk) {
    const auto fits = check_folder_writable(testing::TempDir(), ~std::uint64_t{0} >> 1, "out");
    ASSERT_FALSE(fits);
    EXPECT_EQ(fits.error().kind, ErrorKind::kUnavailable);
    EXPECT_THAT(fits.error().message, HasSubstr("the disk is full: needs "));
}

TEST(CheckFolderWritable, NamesAFileInThePlaceOfAFolder) {
    const fs::path file = fs::path(testing::TempDir()) / "is_a_file";
    std::ofstream(file) << "x";
    const auto fits = check_folder_writable(file / "inside", 1, "out");
    ASSERT_FALSE(fits);
    EXPECT_THAT(fits.error().message, HasSubstr("is_a_file is not a folder"));
    fs::remove(file);
}

}  // namespace
}  // namespace atrium
