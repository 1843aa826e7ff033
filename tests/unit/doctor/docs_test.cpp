#include "tests/support/source_dir.hpp"
#include "tools/doctor/checks/finding.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <regex>
#include <string>
#include <utility>
#include <vector>

namespace atrium::doctor {
namespace {

TEST(DoctorPage, ListsEveryFindingWithItsSeverity) {
    std::ifstream page(atrium::test::source_dir() + "/docs/doctor.md");
    ASSERT_TRUE(page);
    static const std::regex kRow("^\\| `([a-z0-9_]+)` \\| (stops|costs|note) \\|.*");
    std::vector<std::pair<std::string, std::string>> rows;
    std::smatch match;
    for (std::string line; std::getline(page, line);) {
        if (std::regex_match(line, match, kRow)) rows.emplace_back(match[1], match[2]);
    }
    std::vector<std::pair<std::string, std::string>> known;
    for (const KnownFinding& finding : known_findings())
        known.emplace_back(finding.id, name_of(finding.severity));
    EXPECT_EQ(rows, known);
}

}  // namespace
}  // namespace atrium::doctor
