#include "viewer/scene/file_advice.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>

namespace atrium::viewer {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

TEST(FileAdvice, NamesTheFolderAboveIfTheFileIsThere) {
    const fs::path root = fs::temp_directory_path() / ("atrium-advice-" + std::to_string(getpid()));
    fs::create_directories(root / "models");
    std::ofstream(root / "models/bench.obj") << "v 0 0 0\n";
    const Error missing{ErrorKind::kNotFound, "no such file"};
    const auto advice = [&](const fs::path& folder, const std::string& file) {
        return advice_about(missing, folder, file, "mend it");
    };
    const std::string right = "did you mean --viewer.models " + root.string() + "?";
    EXPECT_EQ(advice(root / "models", "models/bench.obj"), right);
    EXPECT_EQ(advice(root / "models" / "", "models/bench.obj"), right);
    EXPECT_THAT(advice(root / "models", "models/chair.obj"), HasSubstr("give the folder of"));
    EXPECT_THAT(advice(".", "models/bench.obj"), HasSubstr("give the folder of"));
    fs::remove_all(root);
}

TEST(FileAdvice, MendsADamagedFile) {
    EXPECT_EQ(advice_about({ErrorKind::kInvalidData, "is damaged"}, "models", "a.png", "mend it"),
              "mend it");
}

}  // namespace
}  // namespace atrium::viewer
