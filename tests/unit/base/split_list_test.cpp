#include "core/base/split_list.hpp"

#include <gmock/gmock.h>

namespace atrium {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

TEST(SplitList, LeavesOutSpacesAndEmptyParts) {
    EXPECT_THAT(split_list("alice, bob ,,"), ElementsAre("alice", "bob"));
    EXPECT_THAT(split_list(" , "), IsEmpty());
    EXPECT_THAT(split_list(""), IsEmpty());
}

TEST(SplitList, SplitsAtTheSeparatorOnly) {
    EXPECT_THAT(split_list("a=1,2,3; b=4,5,6", ';'), ElementsAre("a=1,2,3", "b=4,5,6"));
}

}  // namespace
}  // namespace atrium
