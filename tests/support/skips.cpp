#include "tests/support/skips.hpp"

#include "tests/support/source_dir.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>

namespace atrium::test::skip {
namespace {

constexpr std::array kReasons{kNoSharedData,
                              kNoNetwork,
                              kNoDisplay,
                              kNoEgl,
                              kNoAvx2,
                              kNoWaitTimes,
                              kNoCgal,
                              kNoPythonOpenCv,
                              kNoSystemd,
                              kSanitizer,
                              kRenewed};

void check(const testing::TestResult& result) {
    for (int i = 0; i < result.total_part_count(); ++i) {
        const testing::TestPartResult& part = result.GetTestPartResult(i);
        if (part.skipped() && !is_allowed(part.message()))
            ADD_FAILURE() << "skipped for a reason that is not in tests/support/skips.hpp: "
                          << part.message();
    }
}

class Checker : public testing::EmptyTestEventListener {
    void OnTestEnd(const testing::TestInfo& test) override { check(*test.result()); }
    void OnTestSuiteEnd(const testing::TestSuite& suite) override {
        check(suite.ad_hoc_test_result());
    }
};

// before main(), because some tests have their own
[[maybe_unused]] const bool is_installed = [] {
    testing::UnitTest::GetInstance()->listeners().Append(std::make_unique<Checker>().release());
    return true;
}();

}  // namespace

bool is_allowed(std::string_view message) {
    if (message.starts_with(kNoSharedData))
        return !std::filesystem::exists(atrium::test::source_dir() + "/../shared/data");
    return std::any_of(kReasons.begin(), kReasons.end(), [&](std::string_view reason) {
        return message.starts_with(reason);
    });
}

}  // namespace atrium::test::skip
