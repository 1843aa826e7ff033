#include "site_node/hosts/model_part_watch.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace atrium::hosts {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

TEST(ModelPartWatch, TellsOnceThatNothingComesAndOnceThatItDoes) {
    HostEntry model;
    model.name = "hull";
    model.is_model = true;
    const ModelPartWatch::Time start{};
    ModelPartWatch watch({HostEntry{}, model}, start);
    EXPECT_FALSE(watch.look(false, start + 4s));
    const auto missing = watch.look(false, start + 5s);
    ASSERT_TRUE(missing);
    EXPECT_TRUE(missing->is_warning);
    EXPECT_THAT(missing->line, HasSubstr("model_part_missing host=hull"));
    EXPECT_FALSE(watch.look(false, start + 50s));
    const auto there = watch.look(true, start + 51s);
    ASSERT_TRUE(there);
    EXPECT_FALSE(there->is_warning);
    EXPECT_THAT(there->line, HasSubstr("model_part_there host=hull"));
    EXPECT_FALSE(watch.look(true, start + 52s));
    EXPECT_FALSE(watch.look(false, start + 56s));
    EXPECT_TRUE(watch.look(false, start + 57s));
    EXPECT_TRUE(watch.look(true, start + 58s));
}

}  // namespace
}  // namespace atrium::hosts
